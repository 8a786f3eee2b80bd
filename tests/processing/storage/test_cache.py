"""A cache entry is complete or absent, and what is spoilt is made anew."""

import os
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass, fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.errors import LeaklineError
from processing.storage.cache import Cache, cached
from processing.storage.cache_facts import load_arrays, load_facts, loader, save_arrays, save_facts
from processing.survey import Attitude, Candidate, Channel, Finding, FloatArray, ImuSamples, Severity, Stretch, Track


def write(text):
    return lambda place: place.joinpath("a.txt").write_text(text) and None


@pytest.fixture
def cache(tmp_path):
    return Cache(tmp_path / "cache")


def test_an_entry_is_found_by_step_and_key(cache):
    made = cache.put("track", "abc", write("x"))
    assert cache.get("track", "abc") == made
    assert (made / "a.txt").read_text() == "x"
    assert cache.get("track", "abd") is None
    assert cache.get("sound", "abc") is None


def test_an_entry_is_built_once(cache):
    built = []
    for _ in range(3):
        cache.entry("track", "abc", built.append)
    assert len(built) == 1


def test_what_fails_or_is_cancelled_leaves_nothing(cache):
    def build(place):
        (place / "half").write_text("x")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        cache.put("track", "abc", build)
    assert cache.get("track", "abc") is None
    assert list(cache.root.iterdir()) == []


def test_an_error_of_reading_in_a_build_is_not_told_as_one_of_writing(cache, tmp_path):
    with pytest.raises(FileNotFoundError):
        cache.put("track", "abc", lambda _: (tmp_path / "gone").read_text() and None)


@pytest.mark.parametrize("name", ["", "..", ".", "a/b", "/etc", ".building-1", "a\\b", "ğ", "a" * 101])
def test_a_name_that_could_lead_elsewhere_is_refused(cache, name):
    with pytest.raises(ValueError, match="no name"):
        cache.get("track", name)
    with pytest.raises(ValueError, match="no name"):
        cache.put(name, "abc", write("x"))


def spoil_cut(entry):
    (entry / "a.txt").write_bytes(b"")


def spoil_flip(entry):
    (entry / "a.txt").write_bytes(b"y")  # same size


def spoil_missing(entry):
    (entry / "a.txt").unlink()


def spoil_manifest(entry):
    (entry / "entry.json").write_text("{")


def spoil_manifest_kind(entry):
    (entry / "entry.json").write_text('{"files": [1]}')


@pytest.mark.parametrize("spoil", [spoil_cut, spoil_flip, spoil_missing, spoil_manifest, spoil_manifest_kind])
def test_a_spoilt_entry_is_discarded_and_made_anew(cache, spoil):
    entry = cache.put("track", "abc", write("x"))
    spoil(entry)
    assert cache.get("track", "abc") is None
    assert not entry.exists()
    assert (cache.entry("track", "abc", write("new")) / "a.txt").read_text() == "new"


def test_the_cache_may_be_deleted_at_any_time(cache):
    cache.put("track", "abc", write("x"))
    cache.clear()
    assert cache.get("track", "abc") is None
    assert cache.put("track", "abc", write("x")).exists()


def test_the_longest_unused_go_first_and_those_in_use_stay(tmp_path):
    earlier = Cache(tmp_path)
    for age, key in enumerate(["old", "older", "oldest"], 1):
        entry = earlier.put("track", key, lambda place: (place / "a").write_bytes(bytes(1000)) and None)
        os.utime(entry / "entry.json", (1_000_000 - age, 1_000_000 - age))
    cache = Cache(tmp_path, cap_bytes=3500)
    assert cache.get("track", "oldest") is not None
    cache.put("track", "new", lambda place: (place / "a").write_bytes(bytes(1000)) and None)
    assert {key for key in ("old", "older", "oldest", "new") if cache.get("track", key)} == {"old", "oldest", "new"}
    assert cache.size_bytes() <= 3500


def test_what_a_killed_builder_left_is_swept(cache):
    left = cache.root / ".building-999999999-ab"
    mine = cache.root / f".building-{os.getpid()}-ab"
    for place in (left, mine):
        place.mkdir(parents=True)
    cache.put("track", "abc", write("x"))
    assert not left.exists()
    assert mine.exists()


def test_two_that_make_the_same_entry_get_the_same_one(cache):
    def build(place):
        write("x")(place)
        Cache(cache.root).put("track", "abc", write("x"))

    assert (cache.put("track", "abc", build) / "a.txt").read_text() == "x"
    assert [p.name for p in cache.root.iterdir()] == ["track"]


def test_a_second_place_is_only_read(tmp_path):
    Cache(tmp_path / "there").put("track", "abc", write("x"))
    cache = Cache(tmp_path / "here", also=tmp_path / "there")
    assert cache.get("track", "abc") == tmp_path / "there" / "track" / "abc"
    assert cache.put("track", "abd", write("y")).is_relative_to(tmp_path / "here")


# --- facts and arrays


def track(rows=50):
    t = np.linspace(0, 5, rows)
    return Track(
        time_s=t,
        chainage_m=t * 0.8,
        position_w_m=np.stack([t, -t, t * 0], axis=1),
        sigma_along_m=t + 0.1,
        sigma_cross_m=t + 0.2,
        sigma_up_m=t + 0.3,
        quat_ws=np.tile([1.0, 0, 0, 0], (rows, 1)),
        speed_mps=t * 0 + 0.8,
        method="rolling",
        findings=(Finding("a", Severity.INFO, {"n": 3, "x": 0.5, "s": "ğ"}),),
        not_assessed=(Stretch(1.0, 2.0, Channel.PATH, "r"),),
        quality={"end_error_m": 0.07},
    )


def imu(rows=50):
    t = np.arange(rows) / 200
    return ImuSamples(t, np.ones((rows, 3)), np.zeros((rows, 3)), t > 0.1, temperature_c=t + 20)


@pytest.mark.parametrize("facts", [track(), track(0), imu(), Attitude(np.eye(4), np.zeros(3), "vqf")])
@pytest.mark.parametrize("mmap", [True, False])
def test_facts_with_arrays_come_back_as_they_were(tmp_path, facts, mmap):
    save_facts(tmp_path, facts)
    back = load_facts(tmp_path, type(facts), mmap=mmap)
    for field in fields(facts):
        before, after = getattr(facts, field.name), getattr(back, field.name)
        if isinstance(before, np.ndarray):
            assert before.dtype == after.dtype
            assert np.array_equal(before, after)
        else:
            assert before == after
    if mmap and facts == facts and isinstance(getattr(back, "time_s", None), np.memmap):
        with pytest.raises(ValueError, match="read-only"):
            back.time_s[0] = 1.0


def test_a_tuple_of_candidates_is_cached_too(cache, candidate):
    found = tuple(candidate(t) for t in (1, 2, 3))
    kind = tuple[Candidate, ...]
    for _ in range(2):
        assert cached(cache, "candidates", "k", lambda: found, save_facts, loader(kind)) == found


def test_a_step_is_computed_once_and_then_loaded(cache):
    runs = []

    def compute():
        runs.append(1)
        return track()

    for _ in range(3):
        result = cached(cache, "track", "k", compute, save_facts, loader(Track))
        assert np.array_equal(result.chainage_m, track().chainage_m)
    assert len(runs) == 1
    cached(None, "track", "k", compute, save_facts, loader(Track))
    assert len(runs) == 2


@dataclass(frozen=True)
class OtherTrack:
    time_s: FloatArray
    wanted_since_the_next_version: float


def test_an_entry_of_another_shape_is_made_anew(cache):
    cached(cache, "track", "k", track, save_facts, loader(Track))
    made = cached(cache, "track", "k", lambda: OtherTrack(np.ones(2), 3.0), save_facts, loader(OtherTrack))
    assert made.wanted_since_the_next_version == 3.0
    again = cached(cache, "track", "k", lambda: pytest.fail("it is there"), save_facts, loader(OtherTrack))
    assert again.wanted_since_the_next_version == 3.0


@given(data=st.data())
def test_any_spoilt_byte_of_an_array_gives_an_array_or_an_error_but_never_a_crash(tmp_path_factory, data):
    place = tmp_path_factory.mktemp("spoilt")
    save_arrays(place, {"a": np.arange(20.0)})
    content = bytearray((place / "array0.npy").read_bytes())
    where = data.draw(st.integers(0, len(content) - 1))
    content[where] = data.draw(st.integers(0, 255))
    if data.draw(st.booleans()):
        content = content[: data.draw(st.integers(0, len(content)))]
    (place / "array0.npy").write_bytes(content)
    with suppress(OSError, ValueError):
        assert load_arrays(place)["a"].nbytes <= len(content)


def test_an_index_that_names_files_elsewhere_is_refused(tmp_path):
    (tmp_path / "arrays.json").write_text('{"a": "../../etc/passwd"}')
    with pytest.raises(ValueError, match="no file name"):
        load_arrays(tmp_path)


def test_objects_are_never_unpickled(tmp_path):
    with pytest.raises(ValueError, match=r"[Oo]bject"):
        save_arrays(tmp_path, {"a": np.array([{}, None], dtype=object)})
    np.save(tmp_path / "array0.npy", np.array([{}], dtype=object), allow_pickle=True)
    (tmp_path / "arrays.json").write_text('{"a": "array0.npy"}')
    with pytest.raises(ValueError, match=r"[Oo]bject"):
        load_arrays(tmp_path)


def test_a_cache_that_cannot_be_written_costs_no_result(tmp_path, caplog):
    (tmp_path / "file").write_text("in the way")
    result = cached(Cache(tmp_path / "file"), "track", "k", track, save_facts, loader(Track))
    assert result.method == "rolling"
    assert "not cached" in caplog.text
    with pytest.raises(LeaklineError):
        Cache(tmp_path / "file").put("track", "k", write("x"))


# --- what can be gone on with ---


def half(place):
    place.joinpath("half").write_text("x" + (place / "half").read_text() if (place / "half").exists() else "x")
    raise KeyboardInterrupt


def test_a_resumable_build_finds_what_the_last_one_left(cache):
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            cache.put("scan", "abc", half, resumable=True)
        assert cache.get("scan", "abc") is None
    seen = []

    def build(place):
        seen.append((place / "half").read_text())
        (place / "half").unlink()
        write("whole")(place)

    entry = cache.entry("scan", "abc", build, resumable=True)
    assert seen == ["xx"]
    assert sorted(p.name for p in entry.iterdir()) == ["a.txt", "entry.json"]
    assert [p.name for p in (cache.root / ".unfinished").iterdir()] == []


def test_what_another_key_left_is_not_taken_up(cache):
    with pytest.raises(KeyboardInterrupt):
        cache.put("scan", "abc", half, resumable=True)
    seen = []
    for step, key, resumable in (("scan", "abd", True), ("sca", "n.abc", True), ("scan", "abc", False)):
        cache.put(step, key, lambda place: seen.append(list(place.iterdir())), resumable=resumable)
    assert seen == [[], [], []]


def test_what_a_killed_process_left_of_a_resumable_build_is_taken_up_by_the_next(cache, tmp_path):
    script = (
        "import os, signal, sys; from pathlib import Path; from processing.storage.cache import Cache\n"
        "def build(place):\n    (place / 'half').write_text('x'); os.kill(os.getpid(), signal.SIGKILL)\n"
        f"Cache(Path({str(cache.root)!r})).put('scan', 'a-b', build, resumable=True)"
    )
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    assert subprocess.run([sys.executable, "-c", script], env=env, timeout=60, check=False).returncode < 0
    seen = []
    cache.put("scan", "a-b", lambda place: seen.append([p.name for p in place.iterdir()]), resumable=True)
    assert seen == [["half"]]


def test_unfinished_folders_are_counted_and_are_the_first_to_go(tmp_path):
    cache = Cache(tmp_path / "cache", cap_bytes=10_000)
    kept = Cache(cache.root).put("track", "old", write("o" * 1000))

    def large(place):
        (place / "half").write_text("x" * 9500)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        cache.put("scan", "abc", large, resumable=True)
    assert cache.size_bytes() > 10_000
    cache.put("track", "new", write("n"))
    assert kept.is_dir()
    assert cache.size_bytes() < 2000
