"""Devices: sound in and out, IMUs over wires and networks. Plain threads, no Qt."""
