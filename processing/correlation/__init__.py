"""Two fixed recordings either side of a leak: how much later B hears it than A, and where on the pipe that is.

Signs
    *Delay* is positive where sensor B hears the sound later than sensor A: the source is nearer to A. With one pipe
    section of length d and speed c the leak lies ``d1 = (d − c·t)/2`` from A.
    Cross-spectra are ``S_ab = E[conj(A)·B]``, as :func:`scipy.signal.csd` has them: a delay t turns their phase by
    ``−2πft``.
Flow
    recordings → spectra (the one slow step) → weighting → correlogram and its peaks → phase fit → pipe → position.
    :mod:`processing.correlation.analysis` puts them together.
"""
