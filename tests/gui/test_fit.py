"""Nothing is cut, nameless or out of reach: each page in both languages, all themes and several sizes."""

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QPushButton, QWidget
from whole_window import settle, whole_window
from window_checks import cut_words, nameless, unreached, without_key

PLAIN = ("data", "path", "sound", "leaks", "report")
LAPTOP, TWICE, LEAST = (1366, 768), (960, 540), (683, 384)  # TWICE: 1920 × 1080 at 200 %


def pages_of(window):
    return (*PLAIN, "correlator", "recording", *sorted(window.work._host.openers))


def show(window, page):
    if window.page == page:
        return
    if page in ("correlator", "recording"):
        getattr(window, page).show()
    elif not window.work.open_page(page):
        window.show_page(page)
    settle()


def cut_on_pages(window, size):
    """Return what is cut, by page."""
    window.resize(*size)
    found = {}
    for page in pages_of(window):
        show(window, page)
        settle()
        if cut := cut_words(window):
            found[page] = cut
    return found


def lines(found):
    return "\n".join(f"{page}: {what}" for page, whats in found.items() for what in whats)


def test_in_english_all_words_fit_and_everything_has_a_name_and_a_key_that_leads_on(qapp, tmp_path):
    with whole_window(qapp, tmp_path, language="en", theme="light") as application:
        window = application.window
        found = cut_on_pages(window, LAPTOP)
        window.activateWindow()
        for page in pages_of(window):
            show(window, page)
            for what in (*nameless(window), *without_key(window), *unreached(window)):
                found.setdefault(page, []).append(what)
    assert found == {}, lines(found)


def test_in_turkish_and_in_the_suns_bold_letters_all_words_fit_on_a_laptop_and_at_twice_the_size(qapp, tmp_path):
    """These are the longest words and the widest letters; ``tests/benchmarks/window_pictures.py`` checks the rest."""
    with whole_window(qapp, tmp_path, language="tr", theme="sun") as application:
        window = application.window
        found = cut_on_pages(window, LAPTOP)
        found |= {f"{page} at 200 %": cut for page, cut in cut_on_pages(window, TWICE).items()}
        window.resize(*LEAST)
        settle()
        size = window.width(), window.height()
    assert found == {}, lines(found)
    assert size == LEAST


def test_a_word_that_is_cut_and_a_button_without_a_key_are_noticed(qtbot):
    """The checks must be able to fail."""
    window = QWidget()
    qtbot.addWidget(window)
    row = QHBoxLayout(window)
    for text, tip in (("Far too long for this", ""), ("Far too long for that", "It is told here")):
        button = QPushButton(text)
        button.setToolTip(tip)
        button.setFixedWidth(30)
        button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        row.addWidget(button)
    row.addWidget(QLineEdit())
    window.show()
    assert [word for word in cut_words(window) if "this" in word]
    assert not [word for word in cut_words(window) if "that" in word]
    assert len(without_key(window)) == 2
    assert len(nameless(window)) == 1
