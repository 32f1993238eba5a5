"""What every node does alike: wait, answer once, take requests, report its health."""
