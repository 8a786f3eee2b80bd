"""The manual is whole in both languages: pages, links, pictures, and every key that it names."""

import re

import pytest
from PIL import Image
from PySide6.QtCore import QTranslator
from PySide6.QtGui import QKeySequence

from app import manual
from app.actions import ACTIONS, Page
from app.manual import CONTEXT, LINK, PAGES, PICTURE, PLACEHOLDER
from processing.messages import LANGUAGES

MOST_BYTES, MOST_WIDTH = 4_000_000, 1000
WORDS = re.compile(r"[^\W\d_]+")
PAGE_NAMES = {page.value for page in Page}
IDS = {row.id for row in ACTIONS}


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_page_is_there_and_no_other(language):
    assert {file.stem for file in manual.folder(language).glob("*.md")} == set(PAGES)


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("name", PAGES)
def test_every_link_picture_and_key_of_a_page_leads_somewhere(name, language):
    text = manual.raw(name, language)
    assert text.startswith("# ")
    for link in LINK.findall(text):
        assert link.removesuffix(".md") in PAGES, link
        assert link.endswith(".md")
    for picture in PICTURE.findall(text):
        assert (manual.folder(language) / picture).is_file(), picture
    for kind, thing in PLACEHOLDER.findall(text):
        known = {"keys": PAGE_NAMES, "gestures": {"all"}}.get(kind, IDS)
        assert thing in known, f"{{{kind}:{thing}}}"
    assert "{" not in PLACEHOLDER.sub("", text)


@pytest.mark.parametrize("language", LANGUAGES)
def test_no_key_is_written_down_a_second_time(language):
    """Keys come from the table; a key in the text would be wrong as soon as the table changes."""
    taken = {key for row in ACTIONS for key in row.keys if "+" in key or (key.startswith("F") and key[1:].isdigit())}
    for name in PAGES:
        for key in re.findall(r"\b(?:(?:Ctrl|Shift|Alt)\+\S+|F\d{1,2})\b", manual.raw(name, language)):
            assert key not in taken, f"{name}: {key}"


def test_both_languages_have_the_same_pictures_links_and_keys():
    for name in PAGES:
        english, turkish = manual.raw(name, "en"), manual.raw(name, "tr")
        for pattern in (PICTURE, LINK, PLACEHOLDER):
            assert set(pattern.findall(english)) == set(pattern.findall(turkish)), name
        assert english.count("\n#") == turkish.count("\n#")
        assert english != turkish


def test_pictures_are_small_enough_to_ship_and_to_show():
    total = 0
    for language in LANGUAGES:
        named = {picture for name in PAGES for picture in PICTURE.findall(manual.raw(name, language))}
        files = set(manual.folder(language).glob("*.png"))
        assert {file.name for file in files} == named
        for file in files:
            total += file.stat().st_size
            with Image.open(file) as picture:
                assert picture.width <= MOST_WIDTH
                assert picture.width >= 300
    assert total < MOST_BYTES


def test_every_page_of_the_window_has_its_page_of_the_manual():
    assert set(CONTEXT.values()) <= set(PAGES)
    assert manual.context("leaks") == "review"
    assert manual.context("something new") == PAGES[0]


def test_keys_are_filled_in_from_the_table(qapp):
    confirm = next(row for row in ACTIONS if row.id == "confirm")
    native = QKeySequence(confirm.keys[0]).toString(QKeySequence.SequenceFormat.NativeText)
    assert f"**{native}** leak" in manual.page("review", "en").markdown
    keys = manual.page("keys", "en").markdown
    for row in ACTIONS:
        if row.keys:
            assert f"| {row.text} | {row.tip} |" in keys, row.id


def test_pages_stay_short_enough_to_be_read(qapp):
    for language in LANGUAGES:
        for name in PAGES:
            words = WORDS.findall(PLACEHOLDER.sub("", manual.raw(name, language)))
            assert 60 <= len(words) <= 420 or name == "keys", f"{name}: {len(words)}"


def test_the_turkish_manual_speaks_of_turkish_keys(qapp):
    translator = QTranslator()
    assert translator.load(str(manual.folder("tr").parent.parent / "translations" / "leakline_tr.qm"))
    qapp.installTranslator(translator)
    try:
        page = manual.page("review", "tr")
    finally:
        qapp.removeTranslator(translator)
    assert page.title == "Değerlendirme: bir tuş, bir karar"
    assert "Onayla" in page.markdown
    assert "Confirm" not in page.markdown
