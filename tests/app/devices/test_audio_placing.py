"""Where blocks lie on the recording's axis, and what is said to be missing between them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.devices.audio_placing import BEHIND, LOST, OVERFLOW, UNTOLD, Placing
from app.devices.audio_stream import Chunk

RATE_HZ = 48_000
AGE_S = 0.05


class Card:
    """A sound card with a true clock: makes the chunks that its callback would bring."""

    def __init__(self, rate_hz=RATE_HZ, seed=1, jitter_s=1e-4):
        self.rate_hz, self.jitter_s = rate_hz, jitter_s
        self.rng = np.random.default_rng(seed)
        self.begun_s = 1_000.0
        self.opening, self.first = 1, 0

    def chunk(self, frames=4_800, overflow=False, age_s=AGE_S, host_s=None):
        digitised_s = self.begun_s + self.first / self.rate_hz
        came_s = digitised_s + age_s + self.rng.normal(0.0, self.jitter_s) if host_s is None else host_s
        made = Chunk(bytes(4 * frames), frames, self.opening, self.first, came_s, age_s, overflow)
        self.first += frames
        return made

    def lose(self, frames):
        """Lose frames that the callback never saw, so that it does not count them."""
        self.begun_s += frames / self.rate_hz

    def reopen(self, gap_s):
        self.begun_s += self.first / self.rate_hz + gap_s
        self.opening, self.first = self.opening + 1, 0


def placed(place, chunks):
    return [block for chunk in chunks for block in place.blocks(chunk)]


def test_what_comes_in_turn_is_placed_in_turn():
    card, place = Card(), Placing(RATE_HZ, 1)
    blocks = placed(place, [card.chunk() for _ in range(100)])
    assert [b.first_frame for b in blocks] == list(range(0, 480_000, 4_800))
    assert not any(b.lost_before for b in blocks)
    assert (place.came, place.lost, place.gaps) == (480_000, 0, 0)
    np.testing.assert_allclose([b.adc_host_s for b in blocks], 1_000.0 + np.arange(100) * 0.1, atol=6e-4)


@pytest.mark.parametrize("gap_s", [0.2, 3.217, 600.0])
def test_a_device_that_comes_back_goes_on_where_the_host_clock_says(gap_s):
    card, place = Card(), Placing(RATE_HZ, 1)
    before = placed(place, [card.chunk() for _ in range(100)])
    card.reopen(gap_s)
    coarse = card.chunk()._replace(age_s=AGE_S - 0.012)  # as a sound server tells of the first
    after = placed(place, [coarse, *(card.chunk() for _ in range(20))])
    assert [b.lost_before for b in after[1:]] == [0] * 20
    assert after[0].lost_before == pytest.approx(gap_s * RATE_HZ, abs=0.002 * RATE_HZ)
    assert after[0].reason == LOST
    assert after[0].first_frame == before[-1].first_frame + 4_800 + after[0].lost_before
    assert place.gaps == 1


def test_nothing_waits_for_ever_when_a_device_comes_back_only_for_a_moment():
    card, place = Card(), Placing(RATE_HZ, 1)
    placed(place, [card.chunk() for _ in range(50)])
    card.reopen(1.0)
    assert place.blocks(card.chunk()) == []
    assert place.waiting_frames == 4_800
    (rest,) = place.rest()
    assert rest.lost_before == pytest.approx(RATE_HZ, abs=100)
    assert place.rest() == []


def test_a_device_that_goes_twice_leaves_two_gaps():
    card, place = Card(), Placing(RATE_HZ, 1)
    blocks = placed(place, [card.chunk() for _ in range(50)])
    for gap_s in (1.0, 2.0):
        card.reopen(gap_s)
        blocks += placed(place, [card.chunk()])
    blocks += place.rest()
    assert [round(b.lost_before / RATE_HZ, 2) for b in blocks if b.lost_before] == [1.0, 2.0]


def test_frames_that_found_no_room_are_counted_exactly():
    card, place = Card(), Placing(RATE_HZ, 1)
    chunks = [card.chunk() for _ in range(60)]
    blocks = placed(place, chunks[:30] + chunks[47:])
    (gap,) = [b for b in blocks if b.lost_before]
    assert (gap.lost_before, gap.reason, gap.first_frame) == (17 * 4_800, BEHIND, 47 * 4_800)
    assert place.lost == 17 * 4_800


def test_frames_without_room_at_the_beginning_of_an_opening_are_part_of_its_gap():
    card, place = Card(), Placing(RATE_HZ, 1)
    placed(place, [card.chunk() for _ in range(50)])
    card.reopen(2.0)
    chunks = [card.chunk() for _ in range(20)]
    blocks = placed(place, chunks[10:])
    assert blocks[0].lost_before == pytest.approx(3.0 * RATE_HZ, abs=100)
    assert sum(b.lost_before for b in blocks) == blocks[0].lost_before


def test_what_the_system_says_it_dropped_is_measured_by_the_clock():
    card, place = Card(), Placing(RATE_HZ, 1)
    placed(place, [card.chunk() for _ in range(100)])
    card.lose(6_000)
    (block,) = place.blocks(card.chunk(overflow=True))
    assert block.lost_before == pytest.approx(6_000, abs=100)
    assert block.reason == OVERFLOW


def test_what_the_system_dropped_without_a_word_is_found_in_the_end():
    card, place = Card(), Placing(RATE_HZ, 1)
    placed(place, [card.chunk() for _ in range(900)])
    card.lose(6_000)
    blocks = placed(place, [card.chunk() for _ in range(250)])
    assert sum(b.lost_before for b in blocks) == pytest.approx(6_000, abs=100)
    assert {b.reason for b in blocks if b.lost_before} == {UNTOLD}


def test_a_server_that_waits_for_a_busy_processor_tells_late_times_and_that_is_no_loss():
    card, place = Card(), Placing(RATE_HZ, 1)  # as measured with eight programs on two processors
    chunks = [card.chunk() for _ in range(900)]
    late_s = np.random.default_rng(2).uniform(0.06, 0.14, 100)
    chunks += [c._replace(host_s=c.host_s + s) for c, s in zip([card.chunk() for _ in range(100)], late_s)]
    chunks += [card.chunk() for _ in range(100)]
    assert not any(b.lost_before for b in placed(place, chunks))


def test_what_came_at_once_is_no_loss_however_the_system_times_it():
    card, place = Card(), Placing(RATE_HZ, 1)
    chunks = []
    for _ in range(60):
        first = card.chunk(4_800, age_s=0.1)
        chunks += [first, card.chunk(240, age_s=0.0, host_s=first.host_s + 2e-4)]
    blocks = placed(place, chunks)
    assert not any(b.lost_before for b in blocks)
    times = np.array([b.adc_host_s - b.first_frame / RATE_HZ for b in blocks])
    np.testing.assert_allclose(times, 1_000.0, atol=6e-4)


def test_a_burst_after_a_stall_is_no_loss():
    card, place = Card(), Placing(RATE_HZ, 1)
    placed(place, [card.chunk() for _ in range(100)])
    stalled = [card.chunk() for _ in range(4)]
    late_s = stalled[-1].host_s
    late = [c._replace(host_s=late_s + 1e-4 * n, age_s=late_s - c.host_s + AGE_S) for n, c in enumerate(stalled)]
    assert not any(b.lost_before for b in placed(place, late + [card.chunk() for _ in range(20)]))


@pytest.mark.parametrize("tells_ages", [True, False])
@pytest.mark.parametrize("stood_s", [0.4, 15.0])
def test_what_a_server_kept_while_we_stood_still_is_no_loss(tells_ages, stood_s):
    card, place = Card(), Placing(RATE_HZ, 1)

    def chunks(count):
        made = [card.chunk(age_s=0.1) for _ in range(count)]
        return made if tells_ages else [c._replace(age_s=float("nan")) for c in made]

    blocks = placed(place, chunks(100))
    kept = chunks(round(stood_s / 0.1))
    end_s = kept[-1].host_s
    kept = [c._replace(host_s=end_s + 1e-3 * n, age_s=c.age_s + end_s - c.host_s) for n, c in enumerate(kept)]
    blocks += placed(place, kept + chunks(100))
    assert not any(b.lost_before for b in blocks)


def test_a_system_that_tells_no_ages_is_timed_by_when_its_blocks_came():
    card, place = Card(), Placing(RATE_HZ, 1)
    chunks = [card.chunk(age_s=0.1)._replace(age_s=float("nan")) for _ in range(50)]
    times = [b.adc_host_s - b.first_frame / RATE_HZ for b in placed(place, chunks)]
    np.testing.assert_allclose(times, 1_000.0, atol=6e-4)


def test_samples_arrive_as_they_are():
    sound = np.arange(-6, 6, dtype=np.int32).reshape(6, 2) << 8
    (block,) = Placing(RATE_HZ, 2).blocks(Chunk(sound.tobytes(), 6, 1, 0, 5.0, 0.1, False))
    np.testing.assert_array_equal(block.frames, sound)


STEP = st.one_of(
    st.tuples(st.just("come"), st.integers(1, 9_600)),
    st.tuples(st.just("lose"), st.integers(1, 48_000)),
    st.tuples(st.just("skip"), st.integers(1, 48_000)),
    st.tuples(st.just("reopen"), st.integers(1, 48_000)),
)


@settings(max_examples=100, deadline=None)
@given(st.lists(STEP, max_size=60), st.integers(0, 2**31))
def test_whatever_happens_every_frame_that_came_lies_once_on_one_unbroken_axis(steps, seed):
    card, place = Card(seed=seed, jitter_s=0.005), Placing(RATE_HZ, 1)
    blocks, came = [], 0
    for what, count in steps:
        if what == "come":
            blocks += place.blocks(card.chunk(count))
            came += count
        elif what == "lose":
            card.lose(count)
        elif what == "skip":
            card.chunk(count)
        else:
            card.reopen(count / RATE_HZ)
    blocks += place.rest()
    assert sum(len(b.frames) for b in blocks) == came == place.came
    end = 0
    for block in blocks:
        assert block.first_frame - block.lost_before == end
        assert block.lost_before >= 0
        assert bool(block.reason) == (block.lost_before > 0)
        end = block.first_frame + len(block.frames)
    assert end == place.came + place.lost
