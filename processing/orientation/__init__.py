"""Calibration, then attitude: one module an estimator, one registry."""
