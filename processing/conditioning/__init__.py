"""Filters for slow scalar channels: Kalman, FIR and their cascades (P2)."""
