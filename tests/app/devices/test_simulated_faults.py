"""Faults do to the samples what their words say, and nothing else."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.devices.simulated.faults import ABSURD_US, Fate, Fault, FaultKind, FaultyRows, parse_faults
from app.devices.simulated.protocols import FrameEncoder, TableEncoder
from app.devices.simulated.source import RowReel
from processing import messages
from processing.errors import ErrorCode, LeaklineError
from processing.importing.frames import FrameDecoder
from processing.live.decoders import decoder_named
from processing.survey import ImuSamples

RATE_HZ = 100.0


def reel(seconds=20.0, *, loop=False):
    count = round(seconds * RATE_HZ)
    time_s = np.arange(count) / RATE_HZ
    values = np.random.default_rng(3).normal(0, 5, (count, 3))
    return RowReel(ImuSamples(time_s + 7.0, values, -values, np.ones(count, np.bool_)), loop=loop)


def suffered(words, block=33, seconds=20.0):
    """All rows after the faults, in one list of (run_s, counter, time_us, fate, due_s, noise)."""
    faulty, source = FaultyRows(parse_faults(words), seed=5), reel(seconds)
    out = []
    while True:
        frames, run_s = source.take(block)
        if not len(frames):
            return out
        rows = faulty.apply(frames, run_s)
        out += zip(
            rows.frames.counter.tolist(), rows.frames.time_us.tolist(), rows.fates, rows.due_s.tolist(), rows.noise
        )


def test_without_faults_all_rows_go_out_at_their_time():
    rows = suffered("")
    assert [c for c, *_ in rows] == list(range(2000))
    assert [t for _, t, *_ in rows] == [10_000 * k for k in range(2000)]
    assert {fate for _, _, fate, _, _ in rows} == {Fate.SENT}
    np.testing.assert_allclose([due for *_, due, _ in rows], np.arange(2000) / RATE_HZ, atol=1e-9)


def test_words_are_read_in_order_of_time():
    plan = parse_faults("unplug@30+3, garbage@10+2,repeat@45,drift=80,audio-drift=-50.5")
    assert plan.faults == (
        Fault(FaultKind.GARBAGE, 10.0, 2.0),
        Fault(FaultKind.UNPLUG, 30.0, 3.0),
        Fault(FaultKind.REPEAT, 45.0, 0.0),
    )
    assert (plan.drift_ppm, plan.audio_drift_ppm) == (80.0, -50.5)


@pytest.mark.parametrize(
    "words", ["fire@3", "garbage", "garbage@x", "drift=fast", "drift=1e9", "lost@1+2+3", "lost@-1"]
)
def test_words_that_are_no_fault_are_refused_with_what_is_known(words):
    with pytest.raises(LeaklineError) as caught:
        parse_faults(words)
    assert caught.value.code is ErrorCode.SIMULATED_FAULT_UNKNOWN
    for language in messages.LANGUAGES:
        assert "absurd-time" in messages.error_sentence(caught.value, language)


@pytest.mark.parametrize("language", messages.LANGUAGES)
def test_every_fault_has_its_words(language):
    assert set(messages.table("simulated_faults", language)) == {k.replace("-", "_") for k in FaultKind}


def test_lost_samples_are_counted_and_not_sent():
    rows = suffered("lost@5+0.5,lost@9")
    lost = [c for c, _, fate, _, _ in rows if fate is Fate.LOST]
    assert lost == [*range(500, 550), 900]
    assert [c for c, *_ in rows] == list(range(2000))


def test_a_stalled_device_neither_counts_nor_sends_but_its_clock_runs_on():
    rows = suffered("stall@5+2")
    assert [c for c, *_ in rows] == list(range(1800))
    times = [t for _, t, *_ in rows]
    assert times[499:501] == [4_990_000, 7_000_000]


def test_a_repeated_sample_is_sent_twice_at_the_same_moment():
    rows = suffered("repeat@4,repeat@6+0.03")
    twice = [(c, t, due) for c, t, fate, due, _ in rows if fate is Fate.TWICE]
    assert [c for c, _, _ in twice] == [400, 600, 601, 602]
    first = [(c, t, due) for c, t, fate, due, _ in rows if fate is Fate.SENT]
    assert all(row in first for row in twice)


def test_a_burst_holds_samples_back_and_loses_none():
    rows = suffered("burst@3+0.5")
    assert [c for c, *_ in rows] == list(range(2000))
    due = np.array([due for *_, due, _ in rows])
    assert np.all(due[300:350] == 3.5)
    assert np.all(np.diff(due) >= 0)


@pytest.mark.parametrize("block", [7, 33, 5000])
def test_a_restarted_device_is_silent_and_begins_to_count_anew(block):
    rows = suffered("restart@5+1,restart@12+1.5", block)
    counters = [c for c, *_ in rows]
    assert counters == [*range(500), *range(600), *range(650)]
    times = [t for _, t, *_ in rows]
    assert times[499:501] == [4_990_000, 0]
    assert times[1099:1101] == [5_990_000, 0]


def test_an_absurd_time_is_one_only():
    rows = suffered("absurd-time@8")
    off = {c: t - 10_000 * c for c, t, *_ in rows if t != 10_000 * c}
    assert off == {800: ABSURD_US}


def test_unplugged_samples_are_known():
    rows = suffered("unplug@8+1")
    assert [c for c, _, fate, _, _ in rows if fate is Fate.UNPLUGGED] == list(range(800, 900))


@pytest.mark.parametrize("encoder", [lambda _: FrameEncoder(), TableEncoder])
def test_noise_costs_no_binary_frame_and_makes_no_false_line(encoder):
    faulty, source = FaultyRows(parse_faults("garbage@2+3"), seed=5), reel(8.0)
    frames, run_s = source.take(10_000)
    rows = faulty.apply(frames, run_s)
    made = encoder(frames)
    noisy = [k for k, noise in enumerate(rows.noise) if noise]
    assert 100 < len(noisy) < 200
    assert min(noisy) >= 200
    assert max(noisy) < 500
    data = made.header() + b"".join(n + d for n, d in zip(rows.noise, made.encode(rows.frames)))
    if made.is_checked:
        decoder = FrameDecoder()
        found = decoder.feed(data)
        assert found.counter.tolist() == list(range(800))
        assert decoder.garbage_bytes == sum(map(len, rows.noise))
    else:
        found = decoder_named("csv").feed(data)
        assert set(range(800)) - set(found.counter.tolist()) <= set(noisy)
    same = np.isin(rows.frames.counter, found.counter)
    assert np.array_equal(found.acc_s_mps2, rows.frames.acc_s_mps2[same])


def test_the_same_seed_makes_the_same_noise():
    assert suffered("garbage@2+3") == suffered("garbage@2+3")


kinds = st.sampled_from([k.value for k in FaultKind])
faults = st.builds(lambda k, at, n: f"{k}@{at / 10}+{n / 10}", kinds, st.integers(0, 60), st.integers(0, 20))


@settings(max_examples=15, deadline=None)
@given(words=st.lists(faults, max_size=6).map(",".join), block=st.integers(20, 700))
def test_whatever_the_plan_what_happens_does_not_depend_on_how_it_is_cut(words, block):
    whole, cut = suffered(words, 5000, 6.0), suffered(words, block, 6.0)
    assert [row[:4] for row in cut] == [row[:4] for row in whole]


def test_laps_follow_each_other_on_one_clock():
    source, times = reel(2.0, loop=True), []
    for _ in range(5):
        frames, run_s = source.take(130)
        times += run_s.tolist()
        assert np.array_equal(frames.time_us, np.round(run_s * 1e6).astype(np.uint64))
    assert len(times) == 130 + 70 + 130 + 70 + 130
    np.testing.assert_allclose(np.diff(times), 1 / RATE_HZ, rtol=1e-6)
