"""What a simulated run is made of: frozen dataclasses with SI units, readable from TOML (:mod:`.scenario_file`).

Everything that the simulated technician knows (names, tie points, pipe) and everything that only nature knows (slip,
sensor errors, leaks) stands here; chance enters only through the seed given to :func:`.run.simulate`.
"""

from dataclasses import dataclass, field

from processing.survey import LeakClass, Motion

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class PipeRoute:
    """The centre line: ``points_m`` (n, 3) local ENU, corners rounded to no tighter than ``bend_radius_m``.

    With ``length_m`` the plan is scaled about its first point until the rounded line is that long; ``closed`` joins the
    last point to the first (for a smooth start, let the first point lie inside a straight side).
    """

    points_m: tuple[Vector, ...] = ((0.0, 0.0, 0.0), (100.0, 0.0, 0.0))
    bend_radius_m: float = 1.0
    length_m: float | None = None
    closed: bool = False


@dataclass(frozen=True)
class Stop:
    """The device stands still at ``chainage_m`` for ``duration_s``.

    With ``spin_radps`` a ball is stuck there and turns on the spot, as if it rolled on.
    """

    chainage_m: float
    duration_s: float
    spin_radps: float = 0.0


@dataclass(frozen=True)
class Drive:
    """How fast: rest, smooth ramps of ``ramp_s``, a cruise at ``speed_mps`` that varies slowly, stops, rest."""

    speed_mps: float = 0.6
    variation: float = 0.1  # rms of the slow variation, as a share of the speed
    variation_period_s: float = 12.0  # the quickest of it
    ramp_s: float = 4.0
    rest_start_s: float = 14.0
    rest_end_s: float = 14.0
    stops: tuple[Stop, ...] = ()


@dataclass(frozen=True)
class Slide:
    """Between two chainages the ball floats or is pushed: ``share`` of the way is slid on top of the usual slip."""

    from_m: float
    to_m: float
    share: float = 1.0


@dataclass(frozen=True)
class Ball:
    """A rolling ball: slip = share of the way that is slid, not rolled; spin turns about the contact normal."""

    radius_m: float = 0.0475
    lever_arm_s_m: Vector = (0.004, -0.003, 0.002)  # from the centre of the ball to the IMU
    slip: float = 0.0
    slip_sigma: float = 0.0
    slip_tau_s: float = 12.0
    spin_sigma_radps: float = 0.0  # at nominal speed
    spin_tau_s: float = 6.0
    bank: bool = True  # in bends it climbs the wall until the contact force is normal to it
    told_radius_m: float | None = None  # what the technician measured; None: the true radius
    slides: tuple[Slide, ...] = ()


@dataclass(frozen=True)
class Carried:
    """A probe carried along the line, x forward: it sways and wobbles while it moves and is held still at stops."""

    step_hz: float = 1.8
    bob_m: float = 0.006
    sway_m: float = 0.008
    wobble_deg: float = 2.0


@dataclass(frozen=True)
class Gait:
    """One way of going on foot, from chainage ``from_m`` on: a cycle of one foot, in shares of ``stride_s``.

    The foot strikes with the heel and comes down flat (``heel_share``), stands flat (``flat_share``), rolls off over
    the toes (``toe_share``) and swings. With ``base_pitch_deg`` it stands on its toes all the time, as when crawling.
    """

    from_m: float = 0.0
    stride_m: float = 1.3
    stride_s: float = 1.08
    heel_share: float = 0.09
    flat_share: float = 0.34
    toe_share: float = 0.18
    clearance_m: float = 0.06
    heel_pitch_deg: float = 20.0  # toes up at the strike
    toe_pitch_deg: float = 55.0  # heel up when the toes leave
    base_pitch_deg: float = 0.0
    creep_deg: float = 1.0  # the heel begins to rise while the foot still counts as flat
    shock_mps2: float = 45.0  # of the strike, median of a log-normal
    drag_mps2: float = 0.0  # rms of the scraping while the foot swings


@dataclass(frozen=True)
class Foot:
    """A sensor on a foot that walks the route: its line lies ``aside_m`` to the left of the route."""

    gaits: tuple[Gait, ...] = (Gait(),)
    variation: float = 0.03  # rms from stride to stride, of length and of time
    aside_m: float = 0.09
    toe_out_deg: float = 6.0
    sway_deg: float = 0.4  # rms tilt of the standing foot about its contact, at 0.7 to 4 Hz
    from_heel_m: Vector = (0.15, 0.0, 0.08)  # from the heel's contact to the sensor: forward, left, up
    from_toe_m: Vector = (-0.06, 0.0, 0.08)


@dataclass(frozen=True)
class Magnetics:
    """The field around: Earth's (ENU from horizontal, vertical, declination) and what the pipe adds along the way."""

    enabled: bool = False
    horizontal_ut: float = 25.4
    down_ut: float = 39.6
    declination_deg: float = 5.9  # Marmara region
    pipe_sigma_ut: float = 0.0  # ferrous disturbance, wandering over pipe_scale_m
    pipe_scale_m: float = 3.0
    hard_iron_s_ut: Vector = (0.0, 0.0, 0.0)
    noise_ut: float = 0.3


@dataclass(frozen=True)
class Imu:
    """The sensor and its errors; ``Imu.perfect()`` has none.

    ``gyro_sampling`` says what a gyro sample is: ``increment`` is the rotation from the sample before to this one
    divided by the period (coning-compensated, what strapdown processors such as Xsens' deliver), so that the
    exponential map of ``gyr·dt`` is exact; ``instant`` is the rate at the moment of the sample, which loses some
    20 cm in 100 m at 100 Hz to coning in bends. Acceleration is always of the moment.
    """

    rate_hz: float = 200.0
    gyro_sampling: str = "increment"
    gyro_noise: float = 1.7e-4  # rad/s/√Hz (0.01 °/s/√Hz)
    gyro_bias_sigma_radps: float = 3.5e-3  # 0.2 °/s turn-on
    gyro_walk: float = 3e-6  # rad/s/√s
    gyro_scale_sigma: float = 2e-3
    gyro_misalignment_sigma_rad: float = 1e-3
    gyro_range_radps: float = 34.9  # 2000 °/s
    gyro_step_radps: float = 1e-5
    gyro_instability_radps: float = 0.0  # flicker noise: the floor of its Allan deviation
    gyro_scale_range: tuple[float, float] = (0.0, 0.0)  # instead of the sigma: even between these, either sign
    gyro_misalignment_range_rad: tuple[float, float] = (0.0, 0.0)
    gyro_g_sensitivity: float = 0.0  # rad/s per m/s² (1 °/s/g: 1.78e-3), each of the nine entries
    latitude_deg: float | None = None  # where Earth's own rotation is felt; None: nowhere
    acc_noise: float = 2e-3  # m/s²/√Hz (200 µg/√Hz)
    acc_bias_sigma_mps2: float = 0.03
    acc_walk: float = 5e-5  # m/s²/√s
    acc_scale_sigma: float = 3e-3
    acc_misalignment_sigma_rad: float = 1e-3
    acc_range_mps2: float = 157.0  # 16 g
    acc_step_mps2: float = 1e-3
    stamp_jitter_s: float = 5e-5
    magnetics: Magnetics = field(default_factory=Magnetics)
    pressure: bool = True
    pressure_noise_kpa: float = 0.05
    static_pressure_kpa: float = 420.0
    device_quaternion: bool = False  # the log also holds the device's own orientation
    device_quaternion_drift_radps: float = 3e-5  # its heading error

    @classmethod
    def perfect(cls, rate_hz: float = 200.0) -> "Imu":
        """Return a sensor without any error."""
        return cls(
            rate_hz=rate_hz, gyro_noise=0, gyro_bias_sigma_radps=0, gyro_walk=0, gyro_scale_sigma=0,
            gyro_misalignment_sigma_rad=0, gyro_range_radps=1e6, gyro_step_radps=0, acc_noise=0, acc_bias_sigma_mps2=0,
            acc_walk=0, acc_scale_sigma=0, acc_misalignment_sigma_rad=0, acc_range_mps2=1e6, acc_step_mps2=0,
            stamp_jitter_s=0, pressure_noise_kpa=0,
        )  # fmt: skip


@dataclass(frozen=True)
class Gap:
    """Rows of imu.csv from ``start_s`` to ``end_s`` are missing."""

    start_s: float
    end_s: float


@dataclass(frozen=True)
class Faults:
    """What goes wrong with the log file, for tests of the import; applied only when writing imu.csv."""

    gaps: tuple[Gap, ...] = ()
    nan_rows: int = 0
    duplicate_rows: int = 0
    swapped_rows: int = 0


@dataclass(frozen=True)
class Local:
    """A sound that belongs to a place: power ``A/(1 + ((s − chainage_m)/half_width_m)²)``, a bell of ``octaves`` (full
    width at half power) around ``centre_hz``; ``snr_db`` is in that band at closest approach, above flow and rolling
    noise at nominal speed. ``flutter`` makes it gurgle, ``turning`` lets it fade as the microphone turns away.

    ``shape`` may be ``exponential``: power ``A·2^(−|s − chainage_m|/half_width_m)``. With ``skew`` it dies away so many
    times as slowly behind the place as before it. ``spectrum``, rising points (Hz, dB), stands instead of the bell;
    ``centre_hz`` and ``octaves`` then only say in which band ``snr_db`` is meant."""

    kind: LeakClass
    chainage_m: float
    half_width_m: float = 1.5
    centre_hz: float = 1300.0
    octaves: float = 1.8
    snr_db: float = 6.0
    name: str = ""
    flutter: float = 0.0
    turning: float = 0.0
    shape: str = "lorentz"
    skew: float = 1.0
    spectrum: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Timed:
    """A sound that belongs to a time, such as traffic above: swells and fades around ``time_s`` (survey time)."""

    kind: LeakClass
    time_s: float
    duration_s: float = 12.0
    centre_hz: float = 70.0
    octaves: float = 1.8
    snr_db: float = 8.0
    name: str = ""


@dataclass(frozen=True)
class Pump:
    """A comb of tones from ``start_s`` to ``end_s``, each weaker than the one before."""

    frequency_hz: float = 49.4
    harmonics: int = 15
    level_dbfs: float = -52.0
    start_s: float = -1e9
    end_s: float = 1e9


@dataclass(frozen=True)
class Joints:
    """Pipe joints that the ball bumps over, felt by both sensors; spacing 0 means none."""

    spacing_m: float = 5.5
    spacing_sigma_m: float = 0.25
    bump_mps2: float = 4.0  # at nominal speed, median of a log-normal
    bump_dbfs: float = -16.0
    magnetic_ut: float = 0.0  # the field of a joint's iron where the ball passes it, median of a log-normal
    magnetic_half_width_m: float = 0.25


@dataclass(frozen=True)
class Knocks:
    """Taps on the shell in the rests at both ends, in the irregular rhythm 1-1-3-1-2 s, that tie the two clocks."""

    at_start: bool = True
    at_end: bool = True
    knock_mps2: float = 25.0
    knock_dbfs: float = -8.0
    stray_per_minute: float = 0.0  # knocks without a joint, anywhere on the way


@dataclass(frozen=True)
class RollingLine:
    """A tone that goes ``order`` times through its period in a turn of the ball, ``level_dbfs`` (rms) at nominal speed.

    Its power grows with the cube of the speed, as rolling noise does.
    """

    order: float
    level_dbfs: float = -50.0


@dataclass(frozen=True)
class Scraping:
    """Bursts of noise in ``band_hz`` while something rubs: so many a minute under way, some ``duration_s`` long."""

    per_minute: float = 0.0
    level_dbfs: float = -45.0
    duration_s: float = 1.0
    band_hz: tuple[float, float] = (1500.0, 5000.0)


@dataclass(frozen=True)
class Sound:
    """The recorder and the noise that is always there; levels are rms in dB of full scale at nominal speed."""

    enabled: bool = True
    rate_hz: int = 44100
    file: str = "audio.wav"
    flow_dbfs: float = -46.0
    flow_drift_db: float = 1.5
    rolling_dbfs: float = -44.0
    rolling_drift_db: float = 2.0
    rolling_modulation: tuple[float, float] = (0.55, 0.25)  # of the power, once and twice a turn
    hiss_dbfs: float = -86.0
    bends_rumble: bool = True  # each bend of 10° and more
    bend_snr_db: float = 4.0
    joints: Joints = field(default_factory=Joints)
    knocks: Knocks = field(default_factory=Knocks)
    local: tuple[Local, ...] = ()
    timed: tuple[Timed, ...] = ()
    pumps: tuple[Pump, ...] = ()
    flow_slope: float = 1.0  # power falls as 1/f^slope; 1 is pink
    flow_corner_hz: float = 15.0  # below it the flow's spectrum is flat
    rolling_band_hz: tuple[float, float] = (250.0, 2500.0)
    rolling_third: float = 0.0  # modulation of its power three times a turn
    rolling_lines: tuple[RollingLine, ...] = ()
    lines_stable_m: float = 8.0  # over which a line's strength and phase wander
    lines_fade_db: float = 1.0  # rms of its strength
    lines_wander_rad: float = 0.25  # rms of its phase
    scraping: Scraping = field(default_factory=Scraping)


@dataclass(frozen=True)
class Clock:
    """Audio against IMU: ``survey_s = start_s + audio_s/(1 + drift_ppm·1e-6)``; ``told`` writes it into survey.toml."""

    start_s: float = -1.7
    drift_ppm: float = 30.0
    told: bool = False


@dataclass(frozen=True)
class Marker:
    """A tie point to be: the device passes ``chainage_m`` and somebody notes time and place, wrong by ``sigma_m``.

    ``by`` is ``chainage``, ``coordinates`` (local east/north/up) or ``both``. Without a chainage it is the end.
    """

    name: str
    chainage_m: float | None = None
    sigma_m: float = 0.5
    by: str = "chainage"


@dataclass(frozen=True)
class Paperwork:
    """What the technician writes into survey.toml besides tie points."""

    title: str = "Simulated run"
    operator: str = "Leakline simulator"
    date: str = ""
    client: str = ""
    material: str = "ductile iron"
    diameter_m: float | None = None
    tell_length: bool = False
    latitude: float | None = None
    longitude: float | None = None
    elevation_m: float | None = None
    tell_heading: bool = True
    tell_route: bool = False
    route_sigma_m: float = 0.5  # the map is shifted by this much, and says so


@dataclass(frozen=True)
class Scenario:
    """One simulated run, complete but for the seed."""

    name: str
    motion: Motion = Motion.ROLLING
    route: PipeRoute = field(default_factory=PipeRoute)
    drive: Drive = field(default_factory=Drive)
    ball: Ball = field(default_factory=Ball)
    carried: Carried = field(default_factory=Carried)
    foot: Foot = field(default_factory=Foot)
    imu: Imu = field(default_factory=Imu)
    faults: Faults = field(default_factory=Faults)
    sound: Sound = field(default_factory=Sound)
    clock: Clock = field(default_factory=Clock)
    markers: tuple[Marker, ...] = ()
    paperwork: Paperwork = field(default_factory=Paperwork)
