"""Binocular sparse coding by matching pursuit: features and reward.

Importing this package imports no ROS.
"""

from sparse_coder.coder import SparseCoder
from sparse_coder.config import SparseCoderConfig
from sparse_coder.percept import Encoding, Gaze, Percept

__all__ = ["Encoding", "Gaze", "Percept", "SparseCoder", "SparseCoderConfig"]
