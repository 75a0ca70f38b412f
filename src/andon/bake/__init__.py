"""What is made once and read by frames: light probes."""
