"""Physically honest runs with known truth, for the demonstration, training and tests."""
