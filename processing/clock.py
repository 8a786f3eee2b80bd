"""Finds how the audio clock runs against the IMU's: from what the operator says, from knocks, or from joint bumps.

``survey_s = start_s + audio_s / (1 + drift)``. Both sensors feel a knock or a bump; the pairs of moments that lie on
one line ``audio − survey = offset + drift · survey`` are counted, and a line is believed only where chance would hardly
give it and no other line comes near (acoustics §6). Else the map is assumed, with the doubt that this deserves.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy import special

from processing.clock_fit import ClockFit, Line, PairKind, Pairs, doubt_of
from processing.clock_measured import Measured, measured_in
from processing.progress import Progress, silent
from processing.settings import ClockSettings
from processing.sound.gaps import outside
from processing.sound.onsets import Events, audio_events, imu_events
from processing.sound.scan import SoundScan
from processing.survey import AudioGap, AudioInfo, ClockMap, Finding, FloatArray, ImuSamples, Severity

_KNOCKS_LOOKED_AT = 12  # the strongest in a zone: more would let chance in
_MIN_KNOCKS = 4
_MIN_BUMPS = 8
_BUMPS_PER_S = 0.4  # so many of the strongest events are looked at
_MOST_BUMPS = 4000  # keeps the search for twelve hours to seconds
_KNOCKING_S = 25.0  # knocks come close together, joints do not
_MAX_SECOND_SHARE = 0.7  # of the best line's pairs; above it the rhythm is ambiguous
_MAX_CHANCE = 1e-4
_EVENT_JITTER_S = 0.006  # of an audio onset against the moment of the blow
_PAIR_SIGMA_S = 0.003  # of one pair, where the fit itself is not asked
_GIVEN_SIGMA_S = 0.005
_DELAY_PERIODS = 0.3  # 1 sigma of the IMU's filter delay, which differs from maker to maker
_CONTACT_S = 0.002  # 1 sigma of the moment of the force against the first sound of a blow
_LEAST_SCATTER_S = 0.001  # of a pair, however well a few agree
_CONTRADICTION_S = 0.1
_WORTH_TELLING_S = 0.002


def align(
    imu: ImuSamples,
    scan: SoundScan | None,
    told: AudioInfo,
    settings: ClockSettings,
    progress: Progress | None = None,
    gaps: Sequence[AudioGap] = (),
) -> ClockFit:
    """Return the map from audio time to survey time, and what it rests on.

    Values in ``told`` win; one that is missing is estimated, and assumed 0 where nothing convincing is found. A start
    that is told is still compared with what the sensors felt: a contradiction is a finding. Values that were measured
    while recording (with their sigmas) say where to look, within ±4 sigma: knocks and bumps there win over them.

    The edges of ``gaps``, where the sound breaks off and begins again, are no knocks.
    """
    progress = progress or silent()
    progress.update(0.0, "clock_aligning")
    measured = measured_in(told)
    if measured is not None and (scan is None or len(imu.time_s) < 3):
        return measured.fit(scan.duration_s if scan is not None else 0.0)
    told = told if measured is None else replace(told, start_time_s=None, drift_ppm=None)
    given = told.start_time_s is not None and told.drift_ppm is not None
    if scan is None or len(imu.time_s) < 3:
        return _given(told) if given else _assumed(told, 0.0, settings)
    period_s = 1.0 / imu.sample_rate_hz
    felt = imu_events(imu)
    felt = Events(felt.time_s - settings.imu_delay_periods * period_s - settings.contact_s, felt.strength)
    progress.update(0.4)
    heard = audio_events(scan)
    heard = heard.only(outside(heard.time_s, gaps)) if gaps else heard
    progress.update(0.6)

    def related(told: AudioInfo, measured: Measured | None = None) -> ClockFit:
        search = _Search(felt, heard, _EVENT_JITTER_S + 0.6 * period_s, told, settings, scan.duration_s, measured)
        start, end = search.knocks()
        return _chosen(start, end, search.bumps(start or end), search, period_s)

    found = _given(told) if given else related(told, measured)
    progress.update(0.8)
    if told.start_time_s is not None or found.clock.basis == "measured":
        free = related(AudioInfo())
        found = replace(
            found,
            findings=(*found.findings, *_contradiction(found.clock, free.clock)),
            pairs=found.pairs or free.pairs,
        )
    progress.update(1.0)
    most = int(min(_MOST_BUMPS, _BUMPS_PER_S * scan.duration_s))
    return replace(found, felt_s=felt.strongest(most).time_s, heard_s=heard.strongest(most).time_s)


class _Search:
    """The events of both sensors and what is known beforehand."""

    def __init__(
        self,
        felt: Events,
        heard: Events,
        tolerance_s: float,
        told: AudioInfo,
        settings: ClockSettings,
        audio_s: float,
        measured: Measured | None = None,
    ) -> None:
        self.felt, self.heard, self.tolerance_s = felt, heard, tolerance_s
        self.told, self.settings, self.audio_s, self.measured = told, settings, audio_s, measured
        self.begin_s = measured.start_s if measured is not None else told.start_time_s or 0.0
        self.middle_s = self.begin_s + audio_s / 2

    @property
    def expected_drift(self) -> float:
        """The drift to look around."""
        if self.measured is not None:
            return self.measured.drift
        return (self.told.drift_ppm or 0.0) * 1e-6

    @property
    def prior(self) -> tuple[float, float]:
        """The drift to be expected and its sigma."""
        if self.measured is not None:
            return self.measured.drift, self.measured.drift_sigma
        return self.expected_drift, self.settings.assumed_drift_sigma_ppm * 1e-6

    @property
    def drift_range(self) -> float:
        """How far around it."""
        if self.measured is not None:
            return self.measured.drift_room
        return 0.0 if self.told.drift_ppm is not None else self.settings.max_drift_ppm * 1e-6

    def shift_at(self, survey_s: float) -> tuple[float, float]:
        """Return audio − survey to be expected then, and how far around it to look."""
        expected = -self.begin_s + self.expected_drift * (survey_s - self.begin_s)
        if self.measured is not None:
            return expected, self.measured.room_s(survey_s)
        room = 0.1 if self.told.start_time_s is not None else self.settings.search_s
        return expected, room + self.drift_range * max(0.0, survey_s - self.begin_s)

    def knocks(self) -> tuple[Line | None, Line | None]:
        """Return the alignment by knocks in the zones at the start and at the end."""
        zone = min(self.settings.knock_zone_s, self.audio_s / 2)
        start = self._zone(self.begin_s, self.begin_s + zone, None)
        end_s = self.begin_s + self.audio_s
        return start, self._zone(end_s - zone, end_s, start)

    def _zone(self, from_s: float, to_s: float, known: Line | None) -> Line | None:
        """Return a line with the expected drift through at least four of the strongest events in a span."""
        centre, room = self.shift_at(0.5 * (from_s + to_s))
        if known is not None:
            centre = known.offset_s + self.expected_drift * (0.5 * (from_s + to_s) - known.middle_s)
            room = 0.05 + self.drift_range * (to_s - known.middle_s)
        # recorders that were started apart put the knocks elsewhere in the zone of each
        margin = 0.0 if known is not None else room
        felt = self.felt.between(from_s - margin, to_s + margin).strongest(_KNOCKS_LOOKED_AT)
        heard = self.heard.between(from_s + centre - margin, to_s + centre + margin).strongest(_KNOCKS_LOOKED_AT)
        survey_s, shift_s = _pairs(felt.time_s, heard.time_s, centre, room)
        drifts = np.array([self.expected_drift])
        chance = self._pairs_by_chance(felt, heard, to_s - from_s)
        line = _best_line(
            survey_s, shift_s, drifts, 0.5 * (from_s + to_s), self.tolerance_s, chance, _MIN_KNOCKS, self.prior
        )
        return line if line is not None and _is_knocking(line) else None

    def _pairs_by_chance(self, felt: Events, heard: Events, span_s: float) -> float:
        return len(felt.time_s) * len(heard.time_s) * 2 * self.tolerance_s / max(span_s, 1.0)

    def bumps(self, known: Line | None) -> Line | None:
        """Return the line through the joint bumps along the way, near ``known`` where there is one."""
        most = int(min(_MOST_BUMPS, _BUMPS_PER_S * self.audio_s))
        felt, heard = self.felt.strongest(most), self.heard.strongest(most)
        if len(felt.time_s) < _MIN_BUMPS:
            return None
        middle_s = 0.5 * float(felt.time_s[0] + felt.time_s[-1])
        centre, room = self.shift_at(middle_s)
        if known is not None:
            centre = known.offset_s + self.expected_drift * (middle_s - known.middle_s)
            room = 0.05 + self.drift_range * abs(middle_s - known.middle_s)
        far = room + self.drift_range * float(felt.time_s[-1] - felt.time_s[0]) / 2
        survey_s, shift_s = _pairs(felt.time_s, heard.time_s, centre, far, self.expected_drift, middle_s)
        step = self.tolerance_s / max(float(felt.time_s[-1] - felt.time_s[0]) / 2, 1.0)
        count = int(np.ceil(self.drift_range / step))
        drifts = self.expected_drift + step * np.arange(-count, count + 1, dtype=np.float64)
        chance = self._pairs_by_chance(felt, heard, float(felt.time_s[-1] - felt.time_s[0]))
        line = _best_line(survey_s, shift_s, drifts, middle_s, self.tolerance_s, chance, _MIN_BUMPS, self.prior)
        return line if line is not None and _halves_agree(line, survey_s, shift_s, room, self.tolerance_s) else None


def _pairs(
    survey_s: FloatArray, audio_s: FloatArray, centre: float, room: float, drift: float = 0.0, middle_s: float = 0.0
) -> tuple[FloatArray, FloatArray]:
    """Return survey times and shifts (audio − survey) of all pairs whose shift is within ``room`` of the expected."""
    expected = survey_s + centre + drift * (survey_s - middle_s)
    first = np.searchsorted(audio_s, expected - room)
    counts = np.searchsorted(audio_s, expected + room) - first
    which = np.repeat(np.arange(len(survey_s)), counts)
    within = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
    partners = audio_s[first[which] + within]
    return survey_s[which], partners - survey_s[which]


def _best_line(
    survey_s: FloatArray,
    shift_s: FloatArray,
    drifts: FloatArray,
    middle_s: float,
    tolerance_s: float,
    expected: float,
    min_pairs: int,
    prior: tuple[float, float],
) -> Line | None:
    """Return the line with most pairs within ±tolerance, or None where it may be chance or another is as good.

    ``expected`` is how many pairs strangers would give a line.
    """
    if len(survey_s) < min_pairs:
        return None
    # the pairs may all lie at one end, far from the middle
    lowest = float(shift_s.min() - np.abs(survey_s - middle_s).max() * np.abs(drifts).max())

    def counted(drift: float) -> npt.NDArray[np.int64]:
        offsets = shift_s - drift * (survey_s - middle_s)
        cells = np.bincount(((offsets - lowest) / tolerance_s).astype(np.int64))
        pairs: npt.NDArray[np.int64] = cells + np.append(cells[1:], 0)
        return pairs

    best, best_drift, best_offset, cells_tried = 0, 0.0, 0.0, 0
    for drift in drifts:
        counts = counted(drift)
        at = int(np.argmax(counts))
        cells_tried += len(counts)
        if counts[at] > best:
            best, best_drift, best_offset = int(counts[at]), float(drift), lowest + (at + 1) * tolerance_s
    second = 0
    for drift in drifts:
        counts = counted(drift)
        elsewhere = np.abs(lowest + (np.arange(len(counts)) + 1) * tolerance_s - best_offset) > 8 * tolerance_s
        second = max(second, int(counts[elsewhere].max(initial=0)))
    chance = cells_tried * float(special.pdtrc(best - 1, expected))
    if best < min_pairs or second > _MAX_SECOND_SHARE * best or chance > _MAX_CHANCE:
        return None
    return _fitted(survey_s, shift_s, best_drift, best_offset, middle_s, tolerance_s, len(drifts) > 1, prior)


def _fitted(
    survey_s: FloatArray,
    shift_s: FloatArray,
    drift: float,
    offset_s: float,
    middle_s: float,
    tolerance_s: float,
    with_drift: bool,
    prior: tuple[float, float],
) -> Line:
    """Return the least-squares line through the pairs near the one found, in three rounds of narrowing."""
    near = np.ones(len(survey_s), np.bool_)
    for reach in (2.0, 1.5, 1.2):
        residual = shift_s - offset_s - drift * (survey_s - middle_s)
        near = np.abs(residual) <= reach * tolerance_s
        if with_drift and np.ptp(survey_s[near]) > 0:
            drift, offset_s = _straight(survey_s[near] - middle_s, shift_s[near], prior)
        else:
            offset_s = float(np.mean(shift_s[near] - drift * (survey_s[near] - middle_s)))
    return Line(offset_s, drift, middle_s, survey_s[near], shift_s[near])


def _straight(x: FloatArray, y: FloatArray, prior: tuple[float, float]) -> tuple[float, float]:
    """Return slope and value at 0 of the least-squares line, the slope held by ``prior`` (value, sigma).

    Over a minute a few milliseconds look like 100 ppm; what crystals do is the better knowledge then.
    """
    expected, sigma = prior
    centre_x, centre_y = float(x.mean()), float(y.mean())
    dx, dy = x - centre_x, y - centre_y - expected * (x - centre_x)
    hold = (_PAIR_SIGMA_S / sigma) ** 2
    slope = expected + float(dx @ dy / (dx @ dx + hold))
    return slope, centre_y - slope * centre_x


def _is_knocking(line: Line) -> bool:
    """Whether at least four of the pairs come as close together as somebody knocks."""
    times = np.sort(line.survey_s)
    return bool(np.any(times[_MIN_KNOCKS - 1 :] - times[: 1 - _MIN_KNOCKS] <= _KNOCKING_S))


def _halves_agree(line: Line, survey_s: FloatArray, shift_s: FloatArray, room: float, tolerance_s: float) -> bool:
    """Whether each half of the run, on its own, has its most pairs at the same offset along that drift."""
    offsets = shift_s - line.drift * (survey_s - line.middle_s)
    for part in (survey_s < line.middle_s, survey_s >= line.middle_s):
        mine = np.sort(offsets[part & (np.abs(offsets - line.offset_s) <= room + tolerance_s)])
        if not len(mine):
            return False
        reach = np.searchsorted(mine, mine + 2 * tolerance_s, side="right") - np.arange(len(mine))
        at = int(np.argmax(reach))
        if abs(mine[at] + tolerance_s - line.offset_s) > 3 * tolerance_s:
            return False
    return True


# --- from lines to a map ---------------------------------------------------------------------------------------------


def _chosen(start: Line | None, end: Line | None, bumps: Line | None, search: _Search, period_s: float) -> ClockFit:
    told, settings = search.told, search.settings
    line, basis = bumps, "bumps"
    if start is not None and end is not None:
        line, basis = _through(start, end, search), "knocks"
    elif (start or end) is not None and bumps is None:
        line, basis = start or end, "knocks"
    if line is None:
        known = search.measured
        return known.fit(search.audio_s) if known is not None else _assumed(told, search.audio_s, settings)
    has_drift = told.drift_ppm is not None or line is bumps or (start is not None and end is not None)
    measured = line.drift if told.drift_ppm is None else told.drift_ppm * 1e-6
    drift = measured if has_drift else search.expected_drift
    # audio = survey + offset + drift·(survey − middle) = (1 + drift)·(survey − start)
    start_s = (drift * line.middle_s - line.offset_s) / (1.0 + drift)
    if told.start_time_s is not None:
        start_s = told.start_time_s
    prior = search.prior[1]
    delay_s = float(np.hypot(_DELAY_PERIODS * period_s, _CONTACT_S))
    doubt = doubt_of(line, delay_s, prior, _LEAST_SCATTER_S)
    drift_sigma = doubt.drift_sigma if has_drift else prior
    drift_sigma = 0.0 if told.drift_ppm is not None else drift_sigma
    doubt = replace(doubt, drift_sigma=drift_sigma)
    sigma_s = doubt.at(search.middle_s)
    params: dict[str, str | float] = {"pairs": line.count, "drift_ppm": drift * 1e6, "sigma_ms": 1000 * sigma_s}
    if has_drift or search.measured is not None:
        findings = [Finding(f"clock_{basis}", Severity.INFO, params)]
    else:
        findings = [Finding("clock_no_drift", Severity.WARNING, params)]
    if doubt.wander_s > _WORTH_TELLING_S:
        findings.append(Finding("clock_wanders", Severity.WARNING, {"wander_ms": 1000 * doubt.wander_s}))
    clock = ClockMap(start_s, drift * 1e6, sigma_s, basis, drift_sigma * 1e6, doubt.settled_s, doubt.settled_sigma_s)
    kinds = ((PairKind.START, start), (PairKind.END, end), (PairKind.BUMPS, bumps))
    pairs = {str(kind): Pairs(part.survey_s, part.shift_s) for kind, part in kinds if part is not None}
    return ClockFit(clock, tuple(findings), pairs)


def _through(start: Line, end: Line, search: _Search) -> Line:
    """Return the line through the knocks at both ends."""
    survey_s = np.concatenate([start.survey_s, end.survey_s])
    shift_s = np.concatenate([start.shift_s, end.shift_s])
    if search.told.drift_ppm is not None:
        drift = search.expected_drift
        offset_s = float(np.mean(shift_s - drift * (survey_s - search.middle_s)))
    else:
        drift, offset_s = _straight(survey_s - search.middle_s, shift_s, search.prior)
    return Line(offset_s, drift, search.middle_s, survey_s, shift_s)


def _given(told: AudioInfo) -> ClockFit:
    """Return what was told."""
    return ClockFit(ClockMap(told.start_time_s or 0.0, told.drift_ppm or 0.0, _GIVEN_SIGMA_S, "given"))


def _contradiction(told: ClockMap, found: ClockMap) -> tuple[Finding, ...]:
    """Return a finding where what was told is off from what both sensors felt by more than both can be."""
    at = found.settled_s
    off_s = abs(float(told.to_audio(at) - found.to_audio(at)))
    sigma_s = float(np.hypot(told.sigma_at(at), found.sigma_at(at)))
    if found.basis == "assumed" or off_s < max(_CONTRADICTION_S, 5 * sigma_s):
        return ()
    params = {"off_s": off_s, "told_s": told.start_s, "found_s": found.start_s, "found_ppm": found.drift_ppm}
    code = "clock_measured_contradicted" if told.basis == "measured" else "clock_told_contradicted"
    return (Finding(code, Severity.WARNING, params),)


def _assumed(told: AudioInfo, audio_s: float, settings: ClockSettings) -> ClockFit:
    """Return what was told, zeros for the rest, and the doubt of that."""
    start_sigma = _GIVEN_SIGMA_S if told.start_time_s is not None else settings.assumed_start_sigma_s
    drift_sigma = 0.0 if told.drift_ppm is not None else settings.assumed_drift_sigma_ppm * 1e-6
    sigma_s = float(np.hypot(start_sigma, drift_sigma * audio_s / 2))
    start_s = told.start_time_s or 0.0
    clock = ClockMap(start_s, told.drift_ppm or 0.0, sigma_s, "assumed", drift_sigma * 1e6, start_s, start_sigma)
    return ClockFit(clock, (Finding("clock_assumed", Severity.WARNING, {"sigma_ms": 1000 * sigma_s}),))
