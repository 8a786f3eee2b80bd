"""Names are safe whatever people type, copies are true, and a full disc is told."""

import errno
import hashlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.errors import ErrorCode, LeaklineError
from processing.storage import files


@given(
    st.text(), st.sampled_from(["../../etc/passwd", "C:\\Windows", "..", ".", "CON", "nul.txt", " a ", "a\x00b", ""])
)
def test_any_text_gives_one_harmless_file_name(text, nasty):
    for name in (files.safe_name(text), files.safe_name(nasty), files.safe_name(nasty + text)):
        assert name
        assert not set(name) & set('<>:"/\\|?*\x00\n')
        assert not name.startswith(".")
        assert not name.endswith((".", " "))
        assert name.split(".")[0].upper() not in {"CON", "NUL", "PRN", "AUX", "COM1", "LPT1"}
        assert len(name.encode("utf-8")) <= 255 - len("-2026-05-04.leakline")


@given(st.text())
def test_a_safe_name_stays_as_it_is(text):
    name = files.safe_name(text)
    assert files.safe_name(name) == name


def test_letters_of_any_language_stay():
    assert files.safe_name("İstasyon Caddesi / ığüşöç") == "İstasyon-Caddesi-ığüşöç"


def test_a_copy_has_the_same_bytes_and_the_hash_of_another_implementation(tmp_path):
    source, target = tmp_path / "a.wav", tmp_path / "deep" / "b.wav"
    source.write_bytes(bytes(range(256)) * 9000)  # more than two chunks
    told = []
    size, sha256 = files.copy_hashed(source, target, told.append)
    assert target.read_bytes() == source.read_bytes()
    assert (size, sha256) == (256 * 9000, hashlib.sha256(source.read_bytes()).hexdigest())
    assert sum(told) == size
    assert len(told) == 3
    assert target.stat().st_mtime == pytest.approx(source.stat().st_mtime)


def test_a_copy_never_overwrites(tmp_path):
    source, target = tmp_path / "a", tmp_path / "b"
    source.write_bytes(b"new")
    target.write_bytes(b"old")
    with pytest.raises(LeaklineError) as caught:
        files.copy_hashed(source, target, lambda _: None)
    assert caught.value.code is ErrorCode.CANNOT_WRITE
    assert target.read_bytes() == b"old"


def test_a_source_that_is_gone_is_told(tmp_path):
    with pytest.raises(LeaklineError) as caught:
        files.copy_hashed(tmp_path / "gone", tmp_path / "b", lambda _: None)
    assert caught.value.code is ErrorCode.FILE_MISSING


@pytest.mark.parametrize(
    ("number", "code"),
    [
        (errno.ENOSPC, ErrorCode.DISC_FULL),
        (errno.EDQUOT, ErrorCode.DISC_FULL),
        (errno.EFBIG, ErrorCode.CANNOT_WRITE),  # 4 GiB on a FAT stick: the disc is not full
        (errno.EROFS, ErrorCode.CANNOT_WRITE),
    ],
)
def test_errors_of_the_system_become_sentences(tmp_path, number, code):
    with pytest.raises(LeaklineError) as caught, files.writing(tmp_path):
        raise OSError(number, "system's words")
    assert caught.value.code is code


def test_json_is_replaced_whole_or_not_at_all(tmp_path):
    path = tmp_path / "a.json"
    files.write_json(path, {"ğ": 1})
    with pytest.raises(TypeError):
        files.write_json(path, {"ğ": object()})
    assert path.read_text(encoding="utf-8") == '{\n "ğ": 1\n}'
    assert list(tmp_path.iterdir()) == [path]
