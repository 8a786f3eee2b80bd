"""The printed lines of P0 and P3, live: with every sort of time before them, prints among them, torn and glued."""

import numpy as np
import pytest

from processing.live.printed_lines import PrintedLinesDecoder

THE_PAPERS = (
    b"Accelerometer(xyz)=0.0620,0.8824,0.5342, Gyroscope(xyz)=5.9206,-4.2116,2.3194, "
    b"Magnetometer(xyz)=-17.0214,12.4512,-32.1250---\n"
)


def values(number):
    return f"Accelerometer(xyz)={number / 100:.4f},0.5,1.0, Gyroscope(xyz)=1.5,-2.5,{number}.25"


def lines(before, count=40, first=0, field=True, end="---\r\n"):
    tail = ", Magnetometer(xyz)=10.5,20.25,-30" if field else ""
    return "".join(f"{before(k)}{values(k)}{tail}{end}" for k in range(first, first + count)).encode()


def no_time(_number):
    return ""


def numbers(found):
    return np.rint(100 * found.acc_s_mps2[:, 0] / 9.80665).astype(int).tolist()


def test_the_papers_own_line_is_in_g_and_degrees():
    found = PrintedLinesDecoder().feed(b"\n" + THE_PAPERS * 3)
    assert found.acc_s_mps2[0] == pytest.approx(np.array([0.0620, 0.8824, 0.5342]) * 9.80665, rel=1e-6)
    assert found.gyr_s_radps[0] == pytest.approx(np.radians([5.9206, -4.2116, 2.3194]), rel=1e-6)
    assert found.mag_s_ut[0] == pytest.approx([-17.0214, 12.4512, -32.1250])
    assert found.time_us.tolist() == [0, 0, 0]
    assert found.counter.tolist() == [0, 1, 2]


@pytest.mark.parametrize(
    ("before", "step_us"),
    [
        (lambda k: f"{1000 + 10 * k} ms: ", 10_000),
        (lambda k: f"[{5_000_000 + 2500 * k} us] ", 2500),
        (lambda k: f"{1.5 + 0.01 * k:.2f} s ", 10_000),
        (lambda k: f"{123456 + 10 * k} ", 10_000),  # an Arduino's millis(), as its rate tells
        (lambda k: f"{10.0 + k / 200:.4f}, ", 5_000),
        (lambda k: f"12:30:{k // 100:02d}.{10 * k % 1000:03d} -> ", 10_000),
        (lambda k: f"2026-05-04 12:30:{k // 100:02d},{10 * k % 1000:03d} ", 10_000),
    ],
    ids=["ms", "us", "s", "bare ms", "bare s", "clock", "date"],
)
def test_a_time_before_the_values_is_found(before, step_us):
    decoder = PrintedLinesDecoder()
    stream = lines(before, 150)
    found = [decoder.feed(stream[at : at + 333]) for at in range(0, len(stream), 333)]
    time_us = np.concatenate([f.time_us for f in found]).astype(np.int64)
    assert decoder.has_time
    assert len(time_us) == 150
    assert np.abs(np.diff(time_us) - step_us).max() <= 1
    assert [n for f in found for n in numbers(f)] == list(range(150))


@pytest.mark.parametrize(
    "before",
    [no_time, lambda k: "IMU: ", lambda k: "7 ", lambda k: f"12:30:{k // 50:02d} ", lambda k: f"{k // 30} "],
    ids=["nothing", "a name", "a number that stands", "whole seconds of a clock", "whole seconds"],
)
def test_what_places_no_sample_is_no_time(before):
    decoder = PrintedLinesDecoder()
    found = decoder.feed(lines(before, 60))
    assert not decoder.has_time
    assert numbers(found) == list(range(60))
    assert not found.time_us.any()


def test_a_clock_goes_on_over_midnight():
    def before(k):
        tenths = 863_900 + k
        return f"{tenths // 36000 % 24:02d}:{tenths // 600 % 60:02d}:{tenths // 10 % 60:02d}.{tenths % 10} "

    decoder = PrintedLinesDecoder()
    stream = lines(before, 300)
    found = [decoder.feed(stream[at : at + 500]).time_us.astype(np.int64) for at in range(0, len(stream), 500)]
    assert set(np.diff(np.concatenate(found)).tolist()) == {100_000}


def test_other_prints_among_the_lines_are_no_garbage():
    decoder = PrintedLinesDecoder()
    stream = lines(no_time, 5) + b"battery 81 %\r\n" + lines(no_time, 5, 5) + b"\x93\xff\x10\n" + lines(no_time, 5, 10)
    assert numbers(decoder.feed(stream)) == list(range(15))
    assert decoder.garbage_bytes == 4


def test_a_line_that_was_broken_off_is_not_taken_for_a_whole_one():
    whole = lines(no_time, 1, 20)
    for keep in range(10, len(whole) - 2):
        decoder = PrintedLinesDecoder()
        stream = lines(no_time, 20) + whole[:keep] + b"\r\nboot\r\n" + lines(no_time, 20, 21)
        assert [n for n in numbers(decoder.feed(stream)) if n != 20] == [*range(20), *range(21, 41)], keep
        if keep < len(whole) - 5:
            decoder = PrintedLinesDecoder()
            assert 20 not in numbers(decoder.feed(stream)), keep


def test_two_lines_that_ran_into_one_another_are_none():
    whole = lines(no_time, 1, 20)
    for keep in range(10, len(whole) - 2):
        decoder = PrintedLinesDecoder()
        found = decoder.feed(lines(no_time, 20) + whole[:keep] + lines(no_time, 20, 21))
        assert [n for n in numbers(found) if n != 21] == [*range(20), *range(22, 41)], keep
        # where the first had not begun its values, the second is whole
        assert np.allclose(np.degrees(found.gyr_s_radps[:, 2]), np.array(numbers(found)) + 0.25), keep


def test_a_device_that_begins_to_print_its_field_is_understood_after_a_few_lines():
    decoder = PrintedLinesDecoder()
    first = decoder.feed(lines(no_time, 20, field=False))
    second = decoder.feed(lines(no_time, 40, 20))
    assert np.isnan(first.mag_s_ut).all()
    assert numbers(second) == list(range(60 - len(second), 60))
    assert len(second) >= 30
    assert second.mag_s_ut[-1].tolist() == [10.5, 20.25, -30.0]


def test_nuls_among_the_letters_are_passed_over():
    decoder = PrintedLinesDecoder()
    assert numbers(decoder.feed(b"\0" * 50 + lines(no_time, 5).replace(b"Gyro", b"\0Gyro"))) == [0, 1, 2, 3, 4]
    assert decoder.garbage_bytes == 55
