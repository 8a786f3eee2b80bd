"""What is done with a recording while it is made: decoding, clocks, levels, a first path; no device, no file, no Qt."""
