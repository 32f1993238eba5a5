"""The bag of a run: rosbag2 directories of MCAP files, written, read and repaired."""
