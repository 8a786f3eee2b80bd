"""Two runs of one main: what was added, taken away and grown is found, and nothing else."""

import csv
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from small_survey import make_folder, make_results

from processing.errors import ErrorCode, LeaklineError
from processing.quantities import Quantities
from processing.repeat_alignment import Alignment, Anchor, align
from processing.repeat_runs import Change, ComparedRun, compare, redecided
from processing.repeat_words import (
    basis_sentences,
    change_sentences,
    change_word,
    growth_text,
    report_sentences,
    write_csv,
)
from processing.reporting.content import make_content
from processing.reporting.options import ReportOptions
from processing.reporting.sheets import page_data
from processing.review_facts import ReviewRecord
from processing.survey import Channel, Decision, Launch, Stretch, TiePoint, Verdict

OLD, NEW = "2025-05-04", "2026-05-04"


@pytest.fixture(scope="module")
def runs(main_twice):
    (_, old), (_, new) = main_twice
    return ComparedRun("new", NEW, new), ComparedRun("old", OLD, old)


@pytest.fixture(scope="module")
def compared(runs):
    return compare(*runs)


def at(comparison, chainage_m):
    (found,) = [p for p in comparison.places if abs(p.chainage_m - chainage_m) < 2.0]
    return found


def test_the_leak_that_stayed_the_one_that_grew_the_new_one_and_the_mended_one_are_told_apart(compared):
    kinds = {m: at(compared, m).change for m in (20.0, 45.0, 65.0, 80.0)}
    assert kinds == {20.0: Change.SAME, 45.0: Change.SAME, 65.0: Change.NEW, 80.0: Change.GONE}
    assert len(compared.places) == 4


def test_neither_gain_nor_speed_makes_growth_and_the_true_growth_is_within_its_interval(compared):
    stayed, grown = at(compared, 20.0), at(compared, 45.0)
    assert abs(stayed.growth_db) < stayed.growth_half95_db
    assert abs(grown.growth_db - 6.0) < grown.growth_half95_db
    assert grown.growth_db == pytest.approx(6.0, abs=2.0)
    assert at(compared, 65.0).growth_db > 3.0
    assert at(compared, 80.0).growth_db < -3.0
    assert at(compared, 65.0).at_least


def test_the_runs_are_put_side_by_side_by_their_common_tie_points(compared):
    assert compared.alignment.basis == "names"
    assert [a.name for a in compared.alignment.anchors] == ["valve chamber", "retrieval"]
    assert not compared.alignment.is_reversed
    places = [p for p in compared.places if p.change is Change.SAME]
    assert all(abs(p.apart_m) < p.half95_m for p in places)


def test_seen_from_the_older_run_the_same_is_new_and_gone(runs, compared):
    turned = compare(runs[1], runs[0])
    assert not turned.ours_newer
    assert [p.change for p in turned.places] == [p.change for p in compared.places]
    assert [p.growth_db for p in turned.places] == pytest.approx([p.growth_db for p in compared.places], abs=0.5)


@pytest.mark.parametrize(
    ("days", "imports", "ours_newer", "is_known"),
    [
        ((NEW, OLD), ("2026-05-04T08:00:00", "2026-05-05T08:00:00"), True, True),  # brought in late: the day counts
        ((NEW, NEW), ("2026-05-04T08:00:00", "2026-05-04T15:00:00"), False, False),  # before and after a repair
        ((NEW, NEW), ("2026-05-04T15:00:00", "2026-05-04T08:00:00"), True, False),
        (("", OLD), ("2025-05-01T08:00:00", "2025-05-04T08:00:00"), False, False),
        (("2062-05-04", NEW), ("2026-05-01T08:00:00", "2026-05-04T08:00:00"), False, False),  # mistyped, yet to come
        (("04.05.2026", OLD), ("2026-05-04T08:00:00", "2025-05-04T08:00:00"), True, False),
    ],
)
def test_which_run_is_the_newer_one_is_never_guessed_silently(compared, days, imports, ours_newer, is_known):
    runs = (compared.ours, compared.theirs)
    mine, other = (
        replace(run, date=day, imported_utc=moment) for run, day, moment in zip(runs, days, imports, strict=True)
    )
    found = compare(mine, other)
    assert (found.ours_newer, found.order_known) == (ours_newer, is_known)
    assert at(found, 80.0).change is (Change.GONE if ours_newer else Change.NEW)
    for language, words in (("en", "imported later"), ("tr", "sonradan içe aktarılan")):
        assert any(words in s for s in basis_sentences(found, Quantities(language))) is not is_known


def test_what_is_rejected_later_leaves_the_other_runs_leak_as_gone_and_all_can_be_taken_back(compared):
    same = at(compared, 20.0)
    candidates = compared.ours.results.candidates
    judged = redecided(compared, candidates, {same.ours.id: Decision(Verdict.REJECTED)})
    place = at(judged, 20.0)
    assert (place.change, place.ours) == (Change.GONE, None)
    assert place.theirs == same.theirs
    assert redecided(judged, candidates, {}).places == compared.places


def test_what_the_newer_run_could_not_hear_is_not_gone(runs):
    new, old = runs
    when = float(np.interp(80.0, new.results.track.chainage_m, new.results.track.time_s))
    deaf = Stretch(when - 8.0, when + 8.0, Channel.SOUND, "sound_silent")
    hard = replace(new, results=replace(new.results, not_assessed=(*new.results.not_assessed, deaf)))
    place = at(compare(hard, old), 80.0)
    assert place.change is Change.NOT_HEARD
    assert np.isnan(place.growth_db)


def test_what_only_one_run_found_but_both_heard_is_not_called_gone_or_new(runs):
    new, old = runs
    missed = tuple(c for c in new.results.candidates if abs(c.chainage_m - 20.0) > 2.0)  # the detector overlooked it
    comparison = compare(replace(new, results=replace(new.results, candidates=missed)), old)
    place = at(comparison, 20.0)
    assert place.change is Change.GONE
    assert place.heard_in_both
    assert change_word(place, "en") == "gone from the list, but still heard"
    assert not at(comparison, 80.0).heard_in_both
    assert any("do not take them for new or mended" in s for s in change_sentences(comparison, Quantities("en")))


def test_what_the_operator_rejected_is_not_compared(runs):
    new, old = runs
    (fresh,) = [c for c in new.results.candidates if abs(c.chainage_m - 65.0) < 2.0]
    judged = replace(new, decisions={fresh.id: Decision(Verdict.REJECTED)})
    assert not [p for p in compare(judged, old).places if p.change is Change.NEW]


def test_the_changes_are_said_in_both_languages(compared):
    first = change_sentences(compared, Quantities("en"))[0]
    assert first == "Changes since 4 May 2025: 1 new, 1 gone, 2 in both runs, 1 of them louder and 0 fainter."
    assert change_sentences(compared, Quantities("tr"))[0].startswith("04.05.2025 tarihinden beri: 1 yeni, 1 kaybolan")
    assert "+" in growth_text(at(compared, 45.0), Quantities("tr"))
    for language in ("en", "tr"):
        assert len(report_sentences(compared, Quantities(language))) >= 8


def test_the_report_has_a_section_on_what_changed(compared):
    content = make_content(
        compared.ours.results, {}, ReviewRecord(changes=partial(report_sentences, compared)), ReportOptions("tr")
    )
    page = page_data(content)
    assert page["changes"][0].startswith("04.05.2025 tarihinden beri: 1 yeni")
    assert len(page["changes"]) == len(report_sentences(compared, Quantities("tr")))
    assert page_data(make_content(compared.ours.results, {}))["changes"] == []


def test_the_table_has_a_line_a_place_with_points_and_metres(compared, tmp_path):
    file = tmp_path / "değişiklikler.csv"
    write_csv(file, compared)
    lines = list(csv.DictReader(file.read_text(encoding="utf-8").splitlines()))
    assert [line["change"] for line in lines] == ["same", "same", "new", "gone"]
    assert float(lines[1]["chainage_m"]) == pytest.approx(at(compared, 45.0).chainage_m, abs=0.01)
    assert lines[3]["leak"] == ""
    assert float(lines[3]["other_chainage_m"]) == pytest.approx(80.0, abs=1.5)


# --- alignment, on paths without sound ---


@pytest.fixture(scope="module")
def straight(tmp_path_factory):
    """Results on a straight pipe of 100 m due east, without tie points."""
    with make_folder(tmp_path_factory.mktemp("straight")) as folder:
        results = make_results(folder)
    return replace(results, survey=replace(results.survey, tie_points=()))


def tied(results, *ties, launch=None):
    points = tuple(TiePoint(name, at_m / 2.0, **more) for name, at_m, more in ties)  # 2 m/s
    return replace(results, survey=replace(results.survey, tie_points=points, launch=launch or Launch()))


def test_a_run_the_other_way_is_seen_by_the_names_of_its_tie_points(straight):
    ours = tied(straight, ("Vana A", 20.0, {}), ("hidrant", 70.0, {}))
    theirs = tied(straight, ("HİDRANT", 25.0, {}), ("vana a", 75.0, {}))
    found = align(ours, theirs)
    assert found.is_reversed
    assert found.to_theirs(np.array([20.0, 45.0, 70.0, 90.0])) == pytest.approx([75.0, 50.0, 25.0, 5.0])
    assert found.to_ours(5.0) == pytest.approx([90.0])


def test_one_common_name_does_not_tell_the_direction_and_the_sounds_are_asked(runs):
    new, _ = runs
    track, scan = new.results.track, new.results.scan
    end_m, end_s = float(track.chainage_m[-1]), float(track.time_s[0] + track.time_s[-1])
    mirrored = replace(track, chainage_m=end_m - track.chainage_m[::-1], time_s=end_s - track.time_s[::-1])
    frames = round(end_s / scan.frame_s) - 1 - np.arange(len(scan.state))
    frames = np.clip(frames, 0, len(frames) - 1)
    heard = replace(
        scan, level_db=scan.level_db[frames], crest_db=scan.crest_db[frames], state=scan.state[frames]
    )  # the same sound from the other end
    at_s = float(np.interp(50.0, track.chainage_m, track.time_s))
    ours, theirs = (
        replace(new.results, survey=replace(new.results.survey, tie_points=(TiePoint("valve", t),), launch=Launch()))
        for t in (at_s, end_s - at_s)
    )
    theirs = replace(theirs, track=mirrored, scan=heard, candidates=(), not_assessed=())
    found = compare(replace(new, results=ours), ComparedRun("back", OLD, theirs))
    assert len(found.alignment.anchors) == 1
    assert found.may_be_reversed
    told = compare(replace(new, results=ours), ComparedRun("back", OLD, theirs), is_reversed=True)
    assert told.alignment.is_reversed
    assert not told.may_be_reversed
    assert not compare(replace(new, results=ours), ComparedRun("same", OLD, ours)).may_be_reversed


def test_a_single_tie_point_with_coordinates_leaves_the_paths_their_say(straight):
    here = Launch(latitude=39.92, longitude=32.85)
    place = {"latitude": 39.92, "longitude": 32.85 + 40.0 / (111_320.0 * np.cos(np.radians(39.92)))}
    run = tied(straight, ("valve", 40.0, place), launch=here)
    track = straight.track
    # the same pipe from its other end: launched 100 m east, heading west
    far = Launch(latitude=39.92, longitude=32.85 + 100.0 / (111_320.0 * np.cos(np.radians(39.92))))
    plan = track.position_w_m * np.array([-1.0, 1.0, 1.0])
    other = tied(replace(straight, track=replace(track, position_w_m=plan)), ("vana", 60.0, place), launch=far)
    found = align(run, other)
    assert (found.basis, found.is_reversed) == ("coordinates", True)
    assert found.to_theirs(20.0) == pytest.approx([80.0], abs=0.7)


def test_a_name_that_means_two_places_does_not_bend_the_pipe(straight):
    ours = tied(straight, ("a", 20.0, {}), ("b", 70.0, {}), ("retrieval", 99.0, {}))
    theirs = tied(straight, ("a", 21.0, {}), ("b", 70.5, {}), ("retrieval", 40.0, {}))
    assert [a.name for a in align(ours, theirs).anchors] == ["a", "b"]


def test_tie_points_told_at_the_same_chainage_are_the_same_place(straight):
    ours = tied(straight, ("MH 1", 50.5, {"chainage_m": 50.0}))
    theirs = tied(straight, ("manhole", 49.0, {"chainage_m": 50.0}))
    found = align(ours, theirs)
    assert found.basis == "chainages"
    assert found.to_theirs(50.5) == pytest.approx([49.0])
    assert found.to_theirs(0.0) == pytest.approx([0.0])


def test_two_launches_in_the_world_put_the_paths_side_by_side(straight):
    here = Launch(latitude=39.92, longitude=32.85)
    there = Launch(latitude=39.92, longitude=32.85 + 30.0 / (111_320.0 * np.cos(np.radians(39.92))))  # 30 m east
    found = align(tied(straight, launch=here), tied(straight, launch=there))
    assert found.basis == "coordinates"
    assert found.to_theirs(np.array([40.0, 80.0])) == pytest.approx([10.0, 50.0], abs=0.6)


def test_with_nothing_in_common_but_the_launch_that_is_said_and_the_direction_is_the_operators(straight):
    found = align(straight, straight)
    assert (found.basis, found.is_reversed) == ("launch", False)
    turned = align(straight, straight, is_reversed=True)
    assert turned.to_theirs(30.0) == pytest.approx([70.0])
    assert found.sigma_at(np.array([0.0, 100.0])) == pytest.approx([0.5, np.hypot(0.5, 0.3)])


def test_mapping_there_and_back_ends_where_it_began():
    bent = Alignment("names", (Anchor("", 10.0, 12.0), Anchor("", 50.0, 51.0), Anchor("", 90.0, 93.0)))
    places = np.linspace(0.0, 120.0, 50)
    assert bent.to_ours(bent.to_theirs(places)) == pytest.approx(places)


def test_runs_without_sound_or_of_other_pipes_are_refused(straight, runs):
    silent_run = ComparedRun("", NEW, replace(runs[0].results, scan=None))
    with pytest.raises(LeaklineError) as caught:
        compare(silent_run, runs[1])
    assert caught.value.code is ErrorCode.REPEAT_NO_PATH
    elsewhere = replace(runs[1].results, track=replace(
        runs[1].results.track, chainage_m=runs[1].results.track.chainage_m + 500.0))  # fmt: skip
    survey = replace(runs[0].results.survey, tie_points=(), launch=Launch())
    with pytest.raises(LeaklineError) as caught:
        compare(ComparedRun("", NEW, replace(runs[0].results, survey=survey)), ComparedRun("", OLD, elsewhere))
    assert caught.value.code is ErrorCode.REPEAT_NOTHING_COMMON
