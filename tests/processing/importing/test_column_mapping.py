"""What columns hold: guessed from names and values, told by the operator, kept for the next file."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.errors import ErrorCode, LeaklineError
from processing.importing.column_mapping import (
    ACC,
    GYR,
    ColumnMapping,
    MappedColumn,
    MappingStore,
    Quantity,
    fingerprint,
)
from processing.importing.folder import ImportOptions, import_folder
from processing.importing.guess import guess_mapping
from processing.importing.text_layout import find_layout
from processing.importing.units import AUTO, FACTORS, factor, unit_named


def guessed(tmp_path, header, values="0.01,1,2,9,4,5,6,7,8,9,10,11,12,13"):
    cells = values.split(",")[: header.count(",") + 1]
    rows = "".join(",".join([f"{0.01 * i:.2f}", *cells[1:]]) + "\n" for i in range(20))
    (tmp_path / "t.csv").write_text(header + "\n" + rows)
    mapping = guess_mapping(find_layout(tmp_path / "t.csv"))
    return {c.quantity.value: (c.column, c.unit) for c in mapping.columns}


@pytest.mark.parametrize(
    ("header", "expected"),
    [
        ("t,ax,ay,az,gx,gy,gz", {"time": (0, AUTO), "acc_x": (1, AUTO), "gyr_z": (6, AUTO)}),
        ("timestamp_ms,accX,accY,accZ,gyroX,gyroY,gyroZ", {"time": (0, "ms"), "acc_y": (2, AUTO), "gyr_x": (4, AUTO)}),
        ("time,wx,wy,wz,fx,ax,ay,az", {"gyr_x": (1, AUTO), "acc_x": (5, AUTO)}),
        ("Time [us],Acc_X [mg],Acc_Y [mg],Acc_Z [mg],Gyr_X [mdps],Gyr_Y [mdps],Gyr_Z [mdps]",
         {"time": (0, "us"), "acc_z": (3, "mg"), "gyr_y": (5, "mdps")}),
        ("t,motionAccelX(G),motionAccelY(G),motionAccelZ(G),rotationRateX(rad/s),rotationRateY(rad/s),rotationRateZ(rad/s)",
         {"time": (0, AUTO), "acc_x": (1, "g"), "gyr_z": (6, "radps")}),
        ("t,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z,q0,q1,q2,q3", {"quat_w": (7, "1"), "quat_z": (10, "1")}),
        ("t,qx,qy,qz,qw,acc x,acc y,acc z,gyro x,gyro y,gyro z", {"quat_x": (1, "1"), "quat_w": (4, "1")}),
        ("t,Lin Acc X,Lin Acc Y,Lin Acc Z,Acc X,Acc Y,Acc Z,Gyr X,Gyr Y,Gyr Z",
         {"acc_x": (4, AUTO), "gyr_x": (7, AUTO)}),
        ("t,L acc x,R acc x,L acc y,R acc y,L acc z,R acc z,L gyr x,R gyr x,L gyr y,R gyr y,L gyr z,R gyr z",
         {"acc_x": (1, AUTO), "acc_y": (3, AUTO), "gyr_x": (7, AUTO), "gyr_z": (11, AUTO)}),
        ("zaman,ivme x,ivme y,ivme z,jiroskop x,jiroskop y,jiroskop z",
         {"time": (0, AUTO), "acc_x": (1, AUTO), "gyr_z": (6, AUTO)}),
        ("t,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z,mag_x,mag_y,mag_z,pressure_hPa,temperature",
         {"mag_x": (7, AUTO), "pressure": (10, "hpa"), "temperature": (11, AUTO)}),
    ],
)  # fmt: skip
def test_names_of_many_loggers_are_understood(tmp_path, header, expected):
    found = guessed(tmp_path, header)
    assert {k: found.get(k) for k in expected} == expected


def test_a_table_without_names_is_understood_by_its_values(tmp_path, rows):
    cells = np.column_stack([rows.time, rows.acc, rows.gyr])
    body = "\n".join(" ".join(f"{v:.5f}" for v in row) for row in cells)
    (tmp_path / "log.txt").write_text(body + "\n")
    recording = import_folder(tmp_path)
    np.testing.assert_allclose(recording.imu.acc_s_mps2, rows.acc, atol=1e-5)
    np.testing.assert_allclose(recording.imu.gyr_s_radps, rows.gyr, atol=1e-5)


def test_what_is_missing_is_listed(tmp_path):
    (tmp_path / "t.csv").write_text("t,acc_x,acc_y,acc_z\n" + "0.1,1,2,3\n" * 5)
    assert guess_mapping(find_layout(tmp_path / "t.csv")).missing == GYR


@pytest.mark.parametrize(
    ("kind", "text", "unit"),
    [
        ("acc", "m/s^2", "mps2"),
        ("acc", "(m/s²)", "mps2"),
        ("acc", "[G]", "g"),
        ("gyr", "deg/s", "dps"),
        ("gyr", "°/s", "dps"),
        ("gyr", "rad/s", "radps"),
        ("mag", "µT", "ut"),
        ("mag", "μT", "ut"),
        ("time", "ns", "ns"),
        ("acc", "furlong", AUTO),
        ("acc", "", AUTO),
    ],
)
def test_units_are_known_by_their_spellings(kind, text, unit):
    assert unit_named(kind, text) == unit


def test_factors_are_those_of_the_definitions():
    assert factor("acc", "g") == 9.80665
    assert factor("gyr", "dps") == np.pi / 180
    assert factor("mag", "gauss") == 100.0
    assert factor("pressure", "hpa") == 0.1


entries = st.sampled_from(Quantity).flatmap(
    lambda q: st.builds(
        MappedColumn, st.integers(0, 4000), st.just(q), st.sampled_from([AUTO, *FACTORS[q.kind]]), st.text(max_size=9)
    )
)
mappings = st.builds(
    ColumnMapping, st.lists(entries, max_size=8).map(tuple), st.none() | st.floats(1e-3, 1e5, exclude_min=True)
)


@settings(max_examples=100, deadline=None)
@given(mappings)
def test_a_mapping_survives_json(mapping):
    assert ColumnMapping.from_json(json.loads(json.dumps(mapping.to_json()))) == mapping


@pytest.mark.parametrize(
    "data",
    [
        None,
        [],
        {},
        {"columns": 3},
        {"columns": [3]},
        {"columns": [{"column": -1, "quantity": "time"}]},
        {"columns": [{"column": 0, "quantity": "colour"}]},
        {"columns": [{"column": 0, "quantity": "acc_x", "unit": "dps"}]},
        {"columns": [], "sample_rate_hz": -3},
    ],
)
def test_what_is_no_mapping_is_refused(data):
    with pytest.raises(ValueError):  # noqa: PT011  # the message is not part of the promise
        ColumnMapping.from_json(data)


@pytest.fixture
def layout(tmp_path):
    (tmp_path / "t.csv").write_text("t,a,b,c,d,e,f\n" + "0,1,2,3,4,5,6\n" * 20)
    return find_layout(tmp_path / "t.csv")


MAPPING = ColumnMapping(tuple(MappedColumn(i + 1, q, AUTO) for i, q in enumerate((*ACC, *GYR))), 100.0)


def test_a_store_gives_back_what_it_was_told(tmp_path, layout):
    store = MappingStore(tmp_path / "kept" / "mappings.json")
    assert store.recall(layout) is None
    store.remember(layout, MAPPING)
    assert MappingStore(tmp_path / "kept" / "mappings.json").recall(layout) == MAPPING


@pytest.mark.parametrize("content", [b"", b"[]", b"{", b'{"x": 1}', bytes(100), b"[" * 100_000])
def test_a_damaged_store_forgets_but_does_not_fail(tmp_path, layout, content):
    (tmp_path / "m.json").write_bytes(content)
    store = MappingStore(tmp_path / "m.json")
    assert store.recall(layout) is None
    store.remember(layout, MAPPING)
    assert store.recall(layout) == MAPPING


def test_a_store_that_cannot_be_written_says_so(tmp_path, layout):
    (tmp_path / "file").write_text("x")
    with pytest.raises(LeaklineError) as caught:
        MappingStore(tmp_path / "file" / "m.json").remember(layout, MAPPING)
    assert caught.value.code is ErrorCode.CANNOT_WRITE


def test_a_fingerprint_is_that_of_the_header_not_of_the_rows(tmp_path, layout):
    (tmp_path / "u.csv").write_text("T,A,B,C,D,E,F\n" + "7,1,2,3,4,5,6\n" * 9)
    (tmp_path / "v.csv").write_text("t,a,b,c,d,e,other\n" + "0,1,2,3,4,5,6\n" * 20)
    assert fingerprint(find_layout(tmp_path / "u.csv")) == fingerprint(layout)
    assert fingerprint(find_layout(tmp_path / "v.csv")) != fingerprint(layout)


def test_a_mapping_beyond_the_file_s_columns_names_the_column(tmp_path, layout):
    wide = ColumnMapping((*MAPPING.columns[1:], MappedColumn(40, Quantity.ACC_X, AUTO, "gone")), 100.0)
    with pytest.raises(LeaklineError) as caught:
        import_folder(tmp_path / "t.csv", ImportOptions(mapping=wide))
    assert (caught.value.code, caught.value.params["column_name"]) == (ErrorCode.COLUMN_MISSING, "gone")
