"""The thread behind the live views, calls in their order, what is remembered, and a laptop that stays awake."""

import threading
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scripted_recorder import Feed, motion_block, sound_block

from app import keep_awake as awake
from app.devices.audio_spec import MOST_CHANNELS
from app.live_worker import FRAME_S, LiveWorker
from app.ordered_calls import OrderedCalls
from app.recording_memory import recall, remembered
from app.recording_page import RecordingPage
from widgets.plot_theme import LIGHT


class CountingView:
    """Pictures hold the numbers of the blocks that are newer than the picture that was drawn."""

    def __init__(self):
        self.blocks, self.pictures, self.threads = [], 0, set()

    def add(self, block):
        self.blocks.append(block)
        self.threads.add(threading.current_thread().name)

    def picture(self, after=None):
        self.pictures += 1
        return (0 if after is None else after[1], len(self.blocks))

    def set_sample_rate(self, rate_hz):
        self.rate_hz = rate_hz

    def restart_path(self):
        self.blocks.append("restart")


@pytest.fixture
def view():
    return CountingView()


@pytest.fixture
def run(view):
    """Start a worker over ``view``; it is stopped after the test."""
    workers = []

    def start(feed, **more):
        ready = threading.Event()
        worker = LiveWorker(feed, more.pop("make_view", lambda: view), ready.set, more.pop("on_fault", print), **more)
        workers.append(worker)
        worker.start()
        return worker, ready

    yield start
    for worker in workers:
        worker.stop()
        worker.join(5.0)
        assert not worker._thread.is_alive()


def until(condition, timeout_s=5.0):
    end = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.002)


def test_a_window_that_takes_no_picture_costs_one_picture(run, view):
    feed = Feed()
    worker, ready = run(feed)
    for _ in range(20):
        feed.add(motion_block(0.0))
        time.sleep(0.01)
    until(lambda: len(view.blocks) == 20)
    assert ready.is_set()
    assert view.pictures == 1
    assert worker.take() is not None
    until(lambda: view.pictures == 2)  # what came meanwhile


def test_pictures_that_are_taken_whenever_the_window_has_time_hold_every_block_once(run, view):
    feed = Feed()
    worker, _ = run(feed)
    taken = []
    for number in range(60):
        feed.add(motion_block(0.0))
        if number % 7 == 0:
            taken.append(worker.take())
        time.sleep(0.004)
    until(lambda: len(view.blocks) == 60)
    until(lambda: (taken.append(worker.take()) or taken[-1] is not None) and taken[-1][1] == 60)
    spans = [picture for picture in taken if picture is not None]
    assert [first for first, _ in spans] == [0, *(last for _, last in spans[:-1])]


def test_no_more_than_thirty_pictures_a_second_are_made(run, view):
    feed = Feed()
    worker, _ = run(feed)
    begun = time.monotonic()
    while time.monotonic() - begun < 0.5:
        feed.add(motion_block(0.0))
        worker.take()
        time.sleep(0.002)
    lasted_s = time.monotonic() - begun
    assert view.pictures <= lasted_s / FRAME_S + 2


def test_an_order_is_done_in_the_workers_thread_between_blocks(run, view):
    feed = Feed()
    worker, _ = run(feed)
    feed.add(motion_block(0.0))
    until(lambda: len(view.blocks) == 1)
    worker.order(lambda seen: seen.restart_path())
    worker.set_sample_rate(48_000.0)
    worker.set_sample_rate(48_000.0)
    until(lambda: len(view.blocks) == 2)
    feed.add(motion_block(0.1))
    until(lambda: len(view.blocks) == 3)
    assert view.blocks[1] == "restart"
    assert view.threads == {"live-views"}
    until(lambda: view.rate_hz == 48_000.0)


def test_a_view_that_stumbles_is_told_once_and_made_anew_with_its_rate(run):
    views, faults, feed = [], [], Feed()

    class Stumbling(CountingView):
        def add(self, block):
            if getattr(block, "first_frame", 0) == 800:
                raise ValueError("stumbled")
            super().add(block)

    def make_view():
        views.append(Stumbling())
        return views[-1]

    worker, _ = run(feed, make_view=make_view, on_fault=faults.append)
    worker.set_sample_rate(8000.0)
    for _ in range(3):
        feed.add(sound_block(800))
        until(lambda: not feed.blocks)
        time.sleep(0.02)
    feed.add(sound_block(1600))
    until(lambda: views[-1].blocks)
    assert len(faults) == 1
    assert len(views) == 4
    assert views[-1].rate_hz == 8000.0


# --- calls in order ---


def test_a_view_that_cannot_be_made_at_all_is_told(run):
    faults, told = [], threading.Event()

    def make_view():
        raise RuntimeError("out of memory")

    def on_fault(fault):
        faults.append(fault)
        told.set()

    run(Feed(), make_view=make_view, on_fault=on_fault)
    assert told.wait(10)
    assert [str(fault) for fault in faults] == ["out of memory"]


def test_calls_are_done_in_the_order_in_which_they_were_asked_for_and_answered_here(qtbot):
    calls = OrderedCalls("test")
    done, answered = [], []

    def slow(number):
        time.sleep(0.02 if number % 2 else 0.0)
        done.append((number, threading.current_thread().name))
        if number == 3:
            raise OSError("three")
        return number

    for number in range(5):
        calls.run(
            lambda n=number: slow(n),
            lambda value: answered.append((value, threading.current_thread())),
            lambda error: answered.append((str(error), threading.current_thread())),
        )
    qtbot.waitUntil(lambda: len(answered) == 5, timeout=5000)
    assert done == [(number, "test") for number in range(5)]
    assert [value for value, _ in answered] == [0, 1, 2, "three", 4]
    assert {thread for _, thread in answered} == {threading.main_thread()}
    qtbot.waitUntil(lambda: calls.idle, timeout=5000)


def test_whoever_has_finished_is_answered_no_more(qtbot):
    calls, answered = OrderedCalls("test"), []
    calls.run(lambda: time.sleep(0.05), answered.append, answered.append)
    assert calls.finish(5.0)
    qtbot.wait(20)
    assert not answered
    stuck = threading.Event()
    calls.run(lambda: stuck.wait(5.0))
    assert not calls.finish(0.02)
    stuck.set()
    assert calls.finish(5.0)


# --- memory ---


@pytest.fixture(scope="module")
def page(qapp):
    return RecordingPage(LIGHT, "en")


KEYS = ("sound", "rate", "channels", "imu", "address", "port", "baud", "protocol", "folder", "motion", "radius_m")


@settings(deadline=None, max_examples=40)
@given(st.dictionaries(st.sampled_from(KEYS), st.text(max_size=12)))
def test_whatever_stands_in_the_preferences_a_page_comes_of_it_and_stays_as_it_is(page, values):
    recall(page, values)
    first = remembered(page)
    recall(page, first)
    assert remembered(page) == first


def test_more_channels_than_any_device_has_do_not_keep_the_page_from_being_built(page):
    recall(page, {"sound": "x", "channels": "99999999"})
    assert remembered(page)["channels"] == str(MOST_CHANNELS)


def test_a_new_page_hears_the_systems_input_and_stores_in_the_documents(page):
    recall(page, {})
    values = remembered(page)
    assert (values["sound"], values["imu"], values["channels"]) == ("default", "none", "1")
    assert Path(values["folder"]).name == "Leakline"


# --- awake ---


@pytest.mark.skipif(not Path("/bin/cat").exists(), reason="needs a program that waits for its standard input")
def test_what_keeps_the_laptop_awake_ends_when_it_is_told_to(monkeypatch):
    children = []
    real = awake.subprocess.Popen

    def started(*words, **more):
        children.append(real(*words, **more))
        return children[-1]

    monkeypatch.setattr(awake, "_command", lambda: ["/bin/cat"])
    monkeypatch.setattr(awake.subprocess, "Popen", started)
    end = awake.keep_awake()
    try:
        assert children[0].poll() is None
    finally:
        end()
    assert children[0].poll() == 0


def test_a_system_that_offers_nothing_is_left_alone(monkeypatch):
    monkeypatch.setattr(awake, "_command", lambda: None)
    awake.keep_awake()()
    monkeypatch.setattr(awake, "_command", lambda: ["/no/such/program"])
    awake.keep_awake()()
