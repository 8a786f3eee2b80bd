"""The feed: in order, bounded, and honest about what it dropped."""

import numpy as np
from fake_devices import noise

from app.devices.live_feed import LiveFeed
from processing.live.stream import MotionBlock, SoundBlock
from processing.survey import ImuSamples


def sound(number, count=100):
    return SoundBlock(noise(count), number, 0.0)


def motion(count):
    return MotionBlock(
        ImuSamples(np.arange(float(count)), np.zeros((count, 3)), np.zeros((count, 3)), np.ones(count, bool)), 0.0
    )


def test_blocks_come_out_once_in_the_order_in_which_they_went_in():
    feed = LiveFeed()
    blocks = [sound(0), motion(3), sound(100), motion(2)]
    for block in blocks:
        feed.add(block)
    assert list(feed.take()) == blocks
    assert feed.take() == ()
    assert feed.dropped == 0


def test_when_it_is_full_the_oldest_blocks_go_and_are_counted():
    feed = LiveFeed(most_bytes=1000)
    for number in range(10):
        feed.add(sound(number))  # 400 bytes each
    assert [block.first_frame for block in feed.take()] == [8, 9]
    assert feed.dropped == 8


def test_many_tiny_blocks_are_bounded_too():
    feed = LiveFeed(most_blocks=50)
    for _ in range(80):
        feed.add(motion(1))
    assert len(feed.take()) == 50
    assert feed.dropped == 30


def test_a_block_larger_than_all_room_is_still_shown():
    feed = LiveFeed(most_bytes=1000)
    feed.add(sound(0))
    feed.add(sound(100, count=10_000))
    assert [len(block.frames) for block in feed.take()] == [10_000]
    assert feed.dropped == 1


def test_what_is_taken_or_cleared_makes_room_and_is_not_counted():
    feed = LiveFeed(most_bytes=1000)
    for _ in range(5):
        feed.add(sound(0))
        feed.add(sound(1))
        feed.take()
    feed.add(sound(2))
    feed.clear()
    assert feed.take() == ()
    assert feed.dropped == 0


def test_a_feed_that_nobody_looks_at_holds_nothing():
    feed = LiveFeed(is_open=False)
    feed.add(sound(0))
    assert feed.take() == ()
    assert feed.dropped == 0
