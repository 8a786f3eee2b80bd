"""From attitude to a track: odometry, standstills, and the fit to what is known, with its interval."""
