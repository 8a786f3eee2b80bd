"""The x-IMU3's stream as rows: what is joined to an inertial message, in which order, and for how long."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from imu_streams import ximu3, ximu3_text

from processing.live.ximu3_rows import Ximu3RowsDecoder

each_sort = pytest.mark.parametrize("write", [ximu3, ximu3_text])


def inertial(write, number, time_us=None):
    return write("I", 2500 * number if time_us is None else time_us, 90.0, 0, 0, 0, 0, 1.0)


@each_sort
def test_each_inertial_message_has_the_latest_of_the_others_before_it(write):
    stream = b"".join(
        [
            inertial(write, 1), write("M", 5000, 0.5, 0, -1), inertial(write, 2), write("Q", 5100, 1, 0, 0, 0),
            write("T", 5100, 21.5), write("M", 7400, 0.25, 0, -1), inertial(write, 3), inertial(write, 4),
        ]
    )  # fmt: skip
    found = Ximu3RowsDecoder().feed(stream)
    assert found.time_us.tolist() == [2500, 5000, 7500, 10_000]
    assert np.array_equal(found.mag_s_ut[:, 0], [np.nan, 25.0, 12.5, 12.5], equal_nan=True)
    assert np.array_equal(found.quat_ws[:, 0], [np.nan, np.nan, 1.0, 1.0], equal_nan=True)
    assert np.array_equal(found.temperature_c, [np.nan, np.nan, 21.5, 21.5], equal_nan=True)
    assert found.gyr_s_radps[0] == pytest.approx([np.pi / 2, 0, 0])
    assert found.acc_s_mps2[0] == pytest.approx([0, 0, 9.80665])


@each_sort
@settings(deadline=None, max_examples=40)
@given(kinds=st.lists(st.sampled_from("IMQT"), min_size=1, max_size=40), cut=st.integers(1, 120))
def test_what_is_joined_does_not_depend_on_how_the_stream_is_cut(write, kinds, cut):
    widths = {"I": 6, "M": 3, "Q": 4, "T": 1}
    stream = b"".join(write(kind, 2500 * k, *[float(k)] * widths[kind]) for k, kind in enumerate(kinds))
    latest, expected = dict.fromkeys("MQT", np.nan), []
    for k, kind in enumerate(kinds):
        if kind == "I":
            expected.append([k, *latest.values()])
        else:
            latest[kind] = k
    decoder = Ximu3RowsDecoder()
    rows = []
    for at in range(0, len(stream), cut):
        found = decoder.feed(stream[at : at + cut])
        rows += np.column_stack(
            [found.time_us / 2500, found.mag_s_ut[:, 0] / 50, found.quat_ws[:, 0], found.temperature_c]
        ).tolist()
    assert np.allclose(rows, expected, equal_nan=True) if expected else not rows


def test_both_sorts_in_one_stream_keep_their_order():
    stream = b"".join(inertial(ximu3 if k % 3 else ximu3_text, k) for k in range(30))
    assert Ximu3RowsDecoder().feed(stream).time_us.tolist() == [2500 * k for k in range(30)]


@each_sort
def test_a_value_that_is_old_is_no_longer_told(write):
    decoder = Ximu3RowsDecoder()
    decoder.feed(write("M", 0, 0.5, 0, -1))
    assert decoder.feed(inertial(write, 0, 1_900_000)).mag_s_ut[0, 0] == 25.0
    assert np.isnan(decoder.feed(inertial(write, 0, 2_100_000)).mag_s_ut).all()


def test_nothing_of_before_is_joined_after_a_pause():
    decoder = Ximu3RowsDecoder()
    decoder.feed(ximu3("M", 0, 0.5, 0, -1) + inertial(ximu3, 1)[:12])
    decoder.restart()
    found = decoder.feed(inertial(ximu3, 2))
    assert found.time_us.tolist() == [5000]
    assert np.isnan(found.mag_s_ut).all()
    assert decoder.garbage_bytes == 12


@each_sort
def test_messages_of_other_kinds_are_no_garbage_and_what_no_sensor_measures_is_unknown(write):
    decoder = Ximu3RowsDecoder()
    found = decoder.feed(
        write("B", 5, 90.0, 4.1, 0) + b'{"ping":null}\r\n' + write("I", 10, np.nan, 1, 1, 1, 1, 1) + inertial(write, 4)
    )
    assert found.time_us.tolist() == [10_000]
    assert 0 < decoder.garbage_bytes < 60


def test_damage_that_looks_like_a_signalling_number_warns_nobody():
    body = b"\xc9" + (2500).to_bytes(8, "little") + bytes.fromhex("010080ff") * 6 + b"\n"
    assert not len(Ximu3RowsDecoder().feed(body + ximu3("M", 2600, 1, 1, 1)))
