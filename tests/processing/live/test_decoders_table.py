"""Lines of imu.csv's columns, live: headers in any order, missed, torn or sent again, and what no header can tell."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.live.table_lines import TableLinesDecoder

NAMES = [
    "time_s", "acc_x_mps2", "acc_y_mps2", "acc_z_mps2", "gyr_x_radps", "gyr_y_radps", "gyr_z_radps", "mag_x_uT",
    "mag_y_uT", "mag_z_uT", "quat_w", "quat_x", "quat_y", "quat_z", "pressure_kPa", "temperature_C",
]  # fmt: skip
SEVEN = NAMES[:7]
MAG, QUAT, REST = NAMES[7:10], NAMES[10:14], NAMES[14:]


def value(name, number):
    """Each column's own numbers; those of a quaternion of length 1 whatever the number."""
    if name in QUAT:
        return (0.5, -0.5, 0.5, -0.5)[QUAT.index(name)]
    if name == "counter":
        return number
    return (
        10.0 + 0.0025 * number if name == "time_s" else 100.0 * NAMES.index(name) + 2 * number if name in NAMES else 7e9
    )


def lines(names, count=10, first=0, end="\n", separator=","):
    return "".join(
        separator.join(f"{value(n, k):.6f}" for n in names) + end for k in range(first, first + count)
    ).encode()


def header(names, end="\n", separator=","):
    return (separator.join(names) + end).encode()


def assert_rows(frames, names, count=10, first=0):
    numbers = np.arange(first, first + count)
    assert frames.time_us.tolist() == (10_000_000 + 2500 * numbers if "time_s" in names else 0 * numbers).tolist()
    columns = {
        **{n: frames.acc_s_mps2[:, i] for i, n in enumerate(NAMES[1:4])},
        **{n: frames.gyr_s_radps[:, i] for i, n in enumerate(NAMES[4:7])},
        **{n: frames.mag_s_ut[:, i] for i, n in enumerate(MAG)},
        **{n: frames.quat_ws[:, i] for i, n in enumerate(QUAT)},
        "pressure_kPa": frames.pressure_kpa,
        "temperature_C": frames.temperature_c,
    }
    for name, column in columns.items():
        expected = [value(name, k) for k in numbers] if name in names else [np.nan] * count
        assert np.array_equal(column, np.array(expected, np.float32), equal_nan=True), name


@settings(deadline=None)
@given(order=st.permutations([*NAMES, "note", "rssi"]), cut=st.integers(1, 200))
def test_a_header_may_name_the_columns_in_any_order_among_others(order, cut):
    stream = header(order) + lines(order)
    decoder = TableLinesDecoder()
    found = [decoder.feed(stream[at : at + cut]) for at in range(0, len(stream), cut)]
    whole = TableLinesDecoder().feed(stream)
    assert_rows(whole, NAMES)
    assert sum(map(len, found)) == 10
    assert decoder.garbage_bytes == 0


@pytest.mark.parametrize(
    ("width", "names"),
    [
        (6, SEVEN[1:]), (7, SEVEN), (9, SEVEN + REST), (10, SEVEN + MAG), (11, SEVEN + QUAT), (12, SEVEN + MAG + REST),
        (13, SEVEN + QUAT + REST), (14, SEVEN + MAG + QUAT), (16, NAMES),
    ],
)  # fmt: skip
def test_where_the_header_was_missed_the_columns_are_those_of_the_contract_by_their_number(width, names):
    assert len(names) == width
    decoder = TableLinesDecoder()
    found = decoder.feed(lines(names, 1)[-5:] + lines(names, first=1))
    assert_rows(found, names, first=1)
    assert decoder.has_time == (width != 6)


@pytest.mark.parametrize("names", [SEVEN, SEVEN + MAG, SEVEN + QUAT, NAMES])
def test_a_counter_at_the_end_is_seen_by_its_going_up_by_one(names):
    decoder = TableLinesDecoder()
    found = decoder.feed(b"\n" + lines([*names, "counter"], first=70))
    assert_rows(found, names, first=70)
    assert found.counter.tolist() == list(range(70, 80))


def test_what_stands_in_a_quaternions_place_and_is_none_is_not_read():
    names = [*SEVEN, *MAG, "something"]
    assert_rows(TableLinesDecoder().feed(b"\n" + lines(names)), SEVEN)


def test_columns_that_cannot_be_told_without_a_header_are_left_out():
    found = TableLinesDecoder().feed(b"\n" + lines([*SEVEN, "something"]))
    assert_rows(found, SEVEN)


def test_names_are_read_in_any_case_with_quotes_a_byte_order_mark_and_other_separators():
    for separator in (",", ";", "\t"):
        names = [f'"{name.upper()}"' for name in NAMES]
        stream = b"\xef\xbb\xbf" + header(names, "\r\n", separator) + lines(NAMES, end="\r\n", separator=separator)
        decoder = TableLinesDecoder()
        assert_rows(decoder.feed(stream), NAMES)
        assert decoder.garbage_bytes == 0


def test_a_device_that_starts_again_may_change_its_columns():
    other = [*REST, *SEVEN[1:], "time_s"]
    decoder = TableLinesDecoder()
    assert_rows(decoder.feed(header(SEVEN) + lines(SEVEN)), SEVEN)
    both = decoder.feed(lines(SEVEN, 3) + b"boot v1.2\n" + header(other) + lines(other, 5))
    assert len(both) == 8
    assert np.isnan(both.pressure_kpa[:3]).all()
    assert_rows(decoder.feed(lines(other, first=5)), other, first=5)
    assert decoder.garbage_bytes == len(b"boot v1.2\n")


def test_a_device_that_starts_again_without_a_header_is_understood_after_a_few_lines():
    decoder = TableLinesDecoder()
    decoder.feed(header(SEVEN) + lines(SEVEN))
    found = decoder.feed(lines(NAMES, 40))
    assert len(found) >= 30
    assert_rows(found, NAMES, len(found), 40 - len(found))


@pytest.mark.parametrize("lost", range(1, len("time_s")))
def test_a_header_whose_beginning_was_missed_is_still_read(lost):
    other = ["time_s", *MAG, *SEVEN[1:]]
    assert_rows(TableLinesDecoder().feed(header(other)[lost:] + lines(other)), other)


def test_the_columns_of_a_header_are_remembered_while_the_device_is_away():
    other = [*MAG, *SEVEN]
    decoder = TableLinesDecoder()
    decoder.feed(header(other) + lines(other) + lines(other, 1, 10)[:-30])
    decoder.restart()
    assert_rows(decoder.feed(lines(other, 1, 20)[12:] + lines(other, first=21)), other, first=21)


def test_a_line_that_lost_its_beginning_is_not_believed_and_one_that_lost_nothing_is():
    assert_rows(TableLinesDecoder().feed(lines(SEVEN)), SEVEN)
    for lost in (1, 2):  # "10.000000" → "0.000000", ".000000"
        assert_rows(TableLinesDecoder().feed(lines(SEVEN)[lost:]), SEVEN, 9, 1)


def test_a_counter_that_a_header_names_is_read():
    names = ["counter", *SEVEN]
    rows = b"".join(f"{k},".encode() + lines(SEVEN, 1, k) for k in (7, 8, 2**32 - 1, 0, 1))
    decoder = TableLinesDecoder()
    assert decoder.feed(header(names) + rows).counter.tolist() == [7, 8, 2**32 - 1, 0, 1]
    assert decoder.has_counter


def test_empty_cells_are_unknown_and_lines_without_a_time_are_none():
    names = [*SEVEN, *MAG]
    decoder = TableLinesDecoder()
    found = decoder.feed(
        header(names)
        + b"1.0,1,2,3,4,5,6,,,\n"
        + b",1,2,3,4,5,6,7,8,9\n"
        + b"1.1,,,,,,,7,8,9\n"
        + b"-1.2,1,2,3,4,5,6,7,8,9\n"
        + b"1.3,1,2,nan,4,5,1e300,7,8,9\n"
        + b"1.4,1,2,3,4,5,6,7,8,9\n"
    )
    assert found.time_us.tolist() == [1_000_000, 1_300_000, 1_400_000]
    assert np.isnan(found.mag_s_ut[0]).all()
    assert np.isnan([found.acc_s_mps2[1, 2], found.gyr_s_radps[1, 2]]).all()
    assert decoder.garbage_bytes == len(b",1,2,3,4,5,6,7,8,9\n1.1,,,,,,,7,8,9\n-1.2,1,2,3,4,5,6,7,8,9\n")


def test_numbers_that_are_no_table_are_not_taken_for_one():
    absurd = b"".join(b"%d,1e300,-1e300,inf,nan,1e300,1,1e300,1e200,1e300,1\n" % k for k in range(9))
    assert np.isnan(TableLinesDecoder().feed(absurd).acc_s_mps2).all()
    falling = b"".join(b"%d,1,2,3,4,5,6\n" % (1000 - k) for k in range(50))
    decoder = TableLinesDecoder()
    assert not len(decoder.feed(falling))
    assert decoder.garbage_bytes > 0.9 * len(falling)
    assert not len(TableLinesDecoder().feed(b"1,2,3,4,5\n" * 50))
    assert not len(TableLinesDecoder().feed(b",".join([b"1"] * 80) + b"\n"))
