"""From attitude to a track: odometry, standstills, and the fit to what is known, with its interval.

The step itself is :func:`processing.position.registry.find_track`; :mod:`processing.position.distance` reads it.
"""
