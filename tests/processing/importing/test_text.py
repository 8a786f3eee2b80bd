"""Text tables as loggers really write them: every dialect gives the same numbers, every damage a count."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.errors import ErrorCode, LeaklineError
from processing.importing.text_blocks import Faults, read_blocks
from processing.importing.text_layout import find_layout

HEADER = ["time", "a", "b", "c"]
VALUES = np.column_stack([np.arange(200) * 0.01, *np.random.default_rng(3).normal(0, 5, (3, 200)).round(4)])


def dialect(separator=",", decimal=".", above="", header=True, tail="", end="\n", comment="", quote=""):
    cells = [[f"{v:.4f}".replace(".", decimal) for v in row] for row in VALUES]
    lines = above.split("\n")[:-1] if above else []
    lines += [comment + separator.join(f"{quote}{h}{quote}" for h in HEADER) + tail] if header else []
    return end.join(lines + [separator.join(row) + tail for row in cells]) + end


def numbers(path, block_bytes=1 << 20, columns=range(4), text_column=None):
    faults = Faults()
    layout = find_layout(path)
    blocks = list(read_blocks(path, layout, list(columns), faults, text_column, block_bytes))
    return np.concatenate([b.values for b in blocks]), faults, layout


DIALECTS = {
    "comma": dialect(),
    "semicolon": dialect(";"),
    "tab": dialect("\t"),
    "blanks": dialect("   "),
    "leading blanks": "\n".join("  " + line for line in dialect("  ").splitlines()) + "\n",
    "decimal comma": dialect(";", ","),
    "tab, decimal comma": dialect("\t", ","),
    "blanks, decimal comma": dialect(" ", ","),
    "no header": dialect(header=False),
    "hash above": dialect(above="# made by a logger\n# on a day\n"),
    "slashes above": dialect("\t", above="// Start Time: Unknown\n// Update Rate: 100.0Hz\n"),
    "per cents above": dialect(above="% a\n% b\n"),
    "commented header": dialect(comment="# "),
    "sep line": dialect(above="sep=,\n"),
    "sep line, trailing comma": dialect(above="sep=,\n", tail=","),
    "trailing semicolon": dialect(";", tail=";"),
    "preamble of other width": dialect(above="Logger: 7\nDate,2026\n\n"),
    "units row": dialect().replace("time,a,b,c\n", "time,a,b,c\ns,m/s²,m/s²,m/s²\n"),
    "three header rows": dialect().replace("time,a,b,c\n", "x,imu,imu,imu\ntime,a,b,c\ns,g,g,g\n"),
    "quoted header": dialect(quote='"'),
    "dos": dialect(end="\r\n"),
    "old mac": dialect(end="\r"),
    "blank lines between": dialect(end="\n\n"),
    "no last line feed": dialect().rstrip("\n"),
    "title rows": dialect(above="Recording of today,,,\n"),
}


@pytest.mark.parametrize("name", DIALECTS)
def test_every_dialect_gives_the_same_numbers(tmp_path, name):
    (tmp_path / "t.csv").write_bytes(DIALECTS[name].encode())
    values, faults, layout = numbers(tmp_path / "t.csv")
    np.testing.assert_allclose(values, VALUES, atol=1e-9)
    assert faults == Faults()
    if "header" in name or name in ("comma", "dos", "units row"):
        assert layout.columns[0].split()[-1] == ("time" if name != "no header" else "1")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1", "cp1254"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_every_encoding_gives_the_same_numbers(tmp_path, encoding, end):
    text = dialect(end=end).replace("time,a", "time (µs),a", 1)
    (tmp_path / "t.csv").write_bytes(text.encode(encoding))
    values, faults, layout = numbers(tmp_path / "t.csv")
    np.testing.assert_allclose(values, VALUES, atol=1e-9)
    assert faults == Faults()
    assert layout.columns[0] == "time (µs)"
    assert layout.units[0] == "µs"


@pytest.mark.parametrize("block_bytes", [17, 64, 1000, 4096])
@pytest.mark.parametrize("name", ["comma", "dos", "decimal comma", "blanks", "blank lines between"])
def test_the_size_of_blocks_does_not_matter(tmp_path, name, block_bytes):
    (tmp_path / "t.csv").write_bytes(DIALECTS[name].encode())
    values, faults, _ = numbers(tmp_path / "t.csv", block_bytes)
    np.testing.assert_allclose(values, VALUES, atol=1e-9)
    assert faults == Faults()


def test_names_and_units_come_from_the_header(tmp_path):
    (tmp_path / "t.csv").write_text("Time (s),Gyroscope X (deg/s),Mag [uT]\n" + "0,1,2\n" * 5)
    layout = find_layout(tmp_path / "t.csv")
    assert layout.columns == ("Time (s)", "Gyroscope X (deg/s)", "Mag [uT]")
    assert layout.units == ("s", "deg/s", "uT")
    (tmp_path / "u.csv").write_text("t;ax;gx\n[s];[m/s^2];[deg/s]\n" + "0,5;1,5;2,5\n" * 5)
    layout = find_layout(tmp_path / "u.csv")
    assert (layout.columns, layout.units) == (("t", "ax", "gx"), ("s", "m/s^2", "deg/s"))
    assert (layout.separator, layout.decimal_comma, layout.data_line) == (";", True, 3)


def test_empty_and_bad_cells_become_nan_and_bad_lines_are_counted(tmp_path):
    lines = dialect().splitlines()
    lines[10] = "0.09,,2,3"
    lines[20] = "0.19,x,2,3"
    lines[30] = "0.29,1,2,"
    lines[40] = "oops"
    lines[50] = "0.49,1"
    lines[60] = "0.59,1,2,3,4,5"
    lines[70] = "# a comment"
    lines[80] = "a,b,c,d"
    (tmp_path / "t.csv").write_text("\n".join(lines) + "\n")
    values, faults, _ = numbers(tmp_path / "t.csv")
    assert (faults.lines, faults.first_line) == (4, 41)
    assert len(values) == 195
    assert np.isnan(values[9, 1])
    assert np.isnan(values[19, 1])
    assert np.isnan(values[29, 3])
    assert np.isnan(values).sum() == 3


def test_a_column_of_nothing_does_not_slow_or_hurt(tmp_path):
    rows = "".join(f"{i},,{i},\n" for i in range(5000))
    (tmp_path / "t.csv").write_text("n,empty,m,last\n" + rows)
    values, faults, _ = numbers(tmp_path / "t.csv")
    np.testing.assert_array_equal(values[:, 0], np.arange(5000))
    assert np.isnan(values[:, [1, 3]]).all()
    assert faults == Faults()


def test_times_of_day_are_handed_on_as_text(tmp_path):
    (tmp_path / "t.csv").write_text("clock,a,b\n" + "".join(f"12:00:{i:02d}.5,{i},2\n" for i in range(60)))
    faults = Faults()
    layout = find_layout(tmp_path / "t.csv")
    assert layout.clock_column == 0
    (block,) = read_blocks(tmp_path / "t.csv", layout, [1], faults, text_column=0)
    assert block.texts[7] == b"12:00:07.5"
    assert block.values[7, 0] == 7.0


NO_TABLES = [b"hello\nworld\n", bytes(range(256)) * 50, bytes(5000), b",,,,\n" * 50, b"1\n2\n3\n"]


@pytest.mark.parametrize("content", NO_TABLES)
def test_what_is_no_table_is_said_to_be_none(tmp_path, content):
    (tmp_path / "t.csv").write_bytes(content)
    with pytest.raises(LeaklineError) as caught:
        find_layout(tmp_path / "t.csv")
    assert caught.value.code is ErrorCode.TEXT_NOT_A_TABLE


@pytest.mark.parametrize(("name", "code"), [("gone", ErrorCode.FILE_MISSING), ("", ErrorCode.FILE_UNREADABLE)])
def test_what_cannot_be_opened_is_said(tmp_path, name, code):
    with pytest.raises(LeaklineError) as caught:
        find_layout(tmp_path / name)
    assert caught.value.code is code


def test_an_empty_file_is_said_to_be_empty(tmp_path):
    (tmp_path / "t.csv").write_bytes(b"")
    with pytest.raises(LeaklineError) as caught:
        find_layout(tmp_path / "t.csv")
    assert caught.value.code is ErrorCode.FILE_EMPTY


@settings(max_examples=60, deadline=None)
@given(
    rows=st.lists(
        st.lists(st.floats(-1e12, 1e12, allow_subnormal=False), min_size=3, max_size=3), min_size=12, max_size=40
    ),
    separator=st.sampled_from([",", ";", "\t", " "]),
)
def test_numbers_survive_the_way_through_a_file_exactly(tmp_path_factory, rows, separator):
    path = tmp_path_factory.mktemp("t") / "t.csv"
    path.write_text("a b c\n".replace(" ", separator) + "".join(separator.join(map(repr, r)) + "\n" for r in rows))
    values, faults, _ = numbers(path, columns=range(3))
    np.testing.assert_array_equal(values, np.array(rows))
    assert faults == Faults()
