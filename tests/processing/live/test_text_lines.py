"""Lines of a stream: whole ones only, however it is cut, and what was no line is counted."""

from hypothesis import example, given, settings
from hypothesis import strategies as st

from processing.live.text_lines import LONGEST, LineCutter

PIECES = st.sampled_from([b"abc", b"\r\n", b"\n", b"\r", b"\0\0", b"x" * (LONGEST - 1), b"y" * 3 * LONGEST, b"1,2"])


@settings(deadline=None)
@given(pieces=st.lists(PIECES, max_size=12), cut=st.integers(1, 2 * LONGEST))
@example(pieces=[b"y" * 3 * LONGEST, b"\n", b"abc", b"\n"], cut=7)
def test_lines_torn_beginnings_and_garbage_do_not_depend_on_the_cuts(pieces, cut):
    stream = b"".join(pieces)
    whole, cutter = LineCutter(), LineCutter()
    expected, is_torn, found, torn = whole.feed(stream), whole.starts_torn, [], []
    for at in range(0, len(stream), cut):
        lines = cutter.feed(stream[at : at + cut])
        torn += [cutter.starts_torn] * bool(lines)
        found += lines
    assert found == expected
    assert torn[:1] == [is_torn] * bool(expected)
    assert not any(torn[1:])
    assert cutter.garbage_bytes == whole.garbage_bytes


def test_the_first_line_may_lack_its_beginning_and_no_other():
    cutter = LineCutter()
    assert cutter.feed(b"c\nabc\nab") == [b"c", b"abc"]
    assert cutter.starts_torn
    assert cutter.feed(b"c\n") == [b"abc"]
    assert not cutter.starts_torn
    cutter.feed(b"ab")
    cutter.restart()
    assert cutter.garbage_bytes == 2
    assert cutter.feed(b"c\nabc\n") == [b"c", b"abc"]
    assert cutter.starts_torn


def test_a_line_that_begins_where_the_stream_does_not_is_whole():
    cutter = LineCutter()
    assert cutter.feed(b"\nabc\n") == [b"abc"]
    assert not cutter.starts_torn
