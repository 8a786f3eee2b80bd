"""The science of Leakline: from raw samples to located leaks. It knows no window, no device and no thread.

Vocabulary (the contract with users' files is the same, see the README's section on files):

Frames
    ``w``  world: local east-north-up (ENU), metres, origin at the launch point unless a CRS is given.
    ``s``  sensor: right-handed, as the device defines it.

Signs
    At rest the accelerometer reads +9.81 m/s² along world up: it measures *specific force*.
    A quaternion is ``(w, x, y, z)``, unit, Hamilton. ``q_ws`` rotates sensor vectors into the world:
    ``v_w = q_ws ⊗ v_s ⊗ q_ws*``.
    Heading: degrees clockwise from north. Roll, pitch, yaw: intrinsic Z-Y-X, yaw counter-clockwise from east.
    Angles are radians inside the code, degrees in files and in settings whose name ends in ``_deg``.

Names
    The frame and the unit stand in the name: ``acc_s_mps2``, ``gyr_s_radps``, ``mag_s_ut``, ``position_w_m``,
    ``time_s``, ``sample_rate_hz``, ``level_db``.
    *Chainage* is metres travelled along the pipe from the launch point; it never decreases while the device drifts on.
    *Tie point*: a moment at which the place of the device is known. *Stretch*: a span of time with a reason.
    ``time_s`` without more is on the IMU clock, called *survey time*; audio has its own clock: :mod:`processing.clock`.

Flow
    recording → calibration → orientation → path → sound in distance → candidates → decisions → report.
    :mod:`processing.pipeline` is the one place where that order is written down. Each step is a pure function
    ``result = step(input, settings, progress)``; only raw data and human decisions are precious.
"""
