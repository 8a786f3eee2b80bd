"""Every warning says what to do, or that nothing is to be done: in both languages, in one form that can be checked."""

import pytest

from processing import messages
from processing.errors import ErrorCode, LeaklineError
from processing.messages import LANGUAGES, THEN
from processing.survey import Finding, Severity

NOTHING = {"en": "Nothing to do.", "tr": "Yapılacak bir şey yok."}
TABLES = ("errors", "findings")
LONGEST = 260  # letters of what to do: more is not read in gloves


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("name", TABLES)
def test_every_text_parts_in_what_is_the_matter_and_what_to_do(language, name):
    for key, text in messages.table(name, language).items():
        what, do = messages.what_and_do(text)
        assert text.count(THEN) == 1, key
        assert what.rstrip().endswith((".", "?", ")", ":")), key
        assert do.endswith("."), key
        assert len(do.split()) >= 2, key
        assert len(do) <= LONGEST, key


@pytest.mark.parametrize("name", TABLES)
def test_what_is_to_be_done_is_something_in_both_languages_or_in_none(name):
    for key, english in messages.table(name, "en").items():
        turkish = messages.table(name, "tr")[key]
        idle = [
            messages.what_and_do(text)[1] == NOTHING[language] for text, language in ((english, "en"), (turkish, "tr"))
        ]
        assert idle[0] == idle[1], key


def test_no_error_leaves_the_operator_with_nothing_to_do():
    for language in LANGUAGES:
        for key, text in messages.table("errors", language).items():
            assert messages.what_and_do(text)[1] != NOTHING[language], key


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_reason_has_what_to_do_beside_it(language):
    assert messages.table("reasons_do", language).keys() == messages.table("reasons", language).keys()
    for key, do in messages.table("reasons_do", language).items():
        assert do.endswith("."), key
        assert THEN not in do


def test_sentences_are_told_whole_and_parted_again():
    error = messages.error_sentence(LeaklineError(ErrorCode.FILE_EMPTY))
    assert messages.what_and_do(error) == ("This file is empty.", "Copy it from the device again.")
    finding = Finding("audio_clipped", Severity.MASKED, {"seconds": 3.0, "share_pct": 1.0})
    assert messages.what_and_do(messages.finding_sentence(finding))[1] == "Lower the gain next time."
    assert messages.reason_sentence("sound_clipped") == "clipped sound → Lower the gain next time."
    assert messages.reason_sentence("no such reason") == "no such reason"
