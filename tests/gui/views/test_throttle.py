import pytest

from widgets.throttle import Throttle


@pytest.fixture
def calls():
    return []


def test_the_first_call_goes_through_at_once(qtbot, calls):
    Throttle(calls.append, 50)(1)
    assert calls == [1]


def test_calls_in_between_are_gathered_and_the_last_one_is_never_lost(qtbot, calls):
    throttle = Throttle(calls.append, 50)
    for number in range(10):
        throttle(number)
    assert calls == [0]
    qtbot.waitUntil(lambda: len(calls) == 2)
    assert calls == [0, 9]


def test_after_its_rest_the_next_call_goes_through_at_once(qtbot, calls):
    throttle = Throttle(calls.append, 20)
    throttle(1)
    qtbot.wait(40)
    throttle(2)
    assert calls == [1, 2]


def test_flush_makes_the_remembered_call_once(qtbot, calls):
    throttle = Throttle(calls.append, 1000)
    throttle(1)
    throttle(2)
    throttle.flush()
    throttle.flush()
    assert calls == [1, 2]


def test_cancel_forgets_the_remembered_call(qtbot, calls):
    throttle = Throttle(calls.append, 20)
    throttle(1)
    throttle(2)
    throttle.cancel()
    qtbot.wait(40)
    assert calls == [1]


def test_a_listener_may_call_the_throttle_again(qtbot, calls):
    throttle = Throttle(lambda n: (calls.append(n), n < 3 and throttle(n + 1)), 10)
    throttle(1)
    qtbot.waitUntil(lambda: calls == [1, 2, 3])


def test_without_calls_nothing_happens(qtbot, calls):
    throttle = Throttle(calls.append, 5)
    throttle.flush()
    qtbot.wait(15)
    assert calls == []
