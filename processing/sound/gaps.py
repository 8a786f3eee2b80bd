"""Spans of a recording's sound that were never heard: the file has zeros there, which are no quiet pipe."""

from collections.abc import Sequence

import numpy as np

from processing.survey import AudioGap, AudioSource, BoolArray, Channel, ClockMap, FloatArray, Stretch

MARGIN_S = 0.1  # on either side: a frame, and the edge at which the sound breaks off


def gap_stretches(audio: AudioSource, clock: ClockMap) -> tuple[Stretch, ...]:
    """Return the gaps, with what is beside them, in survey time."""
    return tuple(
        Stretch(
            float(clock.to_survey(max(gap.start_s - MARGIN_S, 0.0))),
            float(clock.to_survey(gap.end_s + MARGIN_S)),
            Channel.SOUND,
            gap.reason,
        )
        for gap in audio.gaps
    )


def told_once(stretches: Sequence[Stretch], gaps: Sequence[Stretch]) -> tuple[Stretch, ...]:
    """Return stretches of the sound without those within one of the ``gaps``: there it was noticed a second time."""
    return tuple(s for s in stretches if not any(g.start_s <= s.start_s and s.end_s <= g.end_s for g in gaps))


def outside(time_s: FloatArray, gaps: Sequence[AudioGap]) -> BoolArray:
    """Return which moments (n,) of audio time lie neither in a gap nor at its edge."""
    is_out = np.ones(len(time_s), np.bool_)
    for gap in gaps:
        is_out &= (time_s < gap.start_s - MARGIN_S) | (time_s > gap.end_s + MARGIN_S)
    return is_out
