"""Plots above one another share their left and right edge to the pixel: what is under one's finger is one place.

Held for all arrangements, three themes, both languages, and the sizes that a field laptop has at 100 to 200 per cent.
"""

from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, QTranslator
from small_survey import DURATION_S, make_track

from app.page_panels import PagePanels
from app.review_page import ReviewPage
from app.settings import PreferencesStore
from processing.survey import TiePoint
from widgets.level_view import LevelCurves
from widgets.linked_plot import LinkedPlot
from widgets.plot_frame import PlotFrame
from widgets.plot_theme import LIGHT, THEMES
from widgets.time_cursor import TimeCursor

TRANSLATIONS = Path(__file__).resolve().parents[2] / "resources" / "translations"
# of the page without menus and steps; the last one is 1366 × 768 at 200 %
SIZES = ((1220, 690), (900, 520), (560, 330))


@pytest.fixture(params=["en", "tr"])
def language(request, qapp):
    translator = QTranslator()
    if request.param == "tr":
        assert translator.load(str(TRANSLATIONS / "leakline_tr.qm"))
        qapp.installTranslator(translator)
    yield request.param
    qapp.removeTranslator(translator)


@pytest.fixture
def page(language, qtbot, tmp_path):
    cursor, track = TimeCursor(), make_track()
    cursor.set_extent(0.0, DURATION_S)
    cursor.set_track(track)
    page = ReviewPage(cursor, LIGHT)
    qtbot.addWidget(page)
    page.profile.set_track(track)
    page.path.set_track(track)
    # values of every width: what stands left of a plot must not move its edge
    page.level.set_levels(LevelCurves(track.time_s, -100.0 + 1e-3 * track.chainage_m, track.chainage_m))
    page.profile.set_tie_points((TiePoint("Gate valve, Çınar Street", 10.0),))
    panels = PagePanels(page, PreferencesStore(tmp_path / "preferences.json"), page)  # small pages show fewer
    page.show()
    panels.apply()
    return page


def edges(page, plot):
    """Left and right edge of a plot in the page's pixels."""
    rect, corner = plot.plot_rect(), plot.mapTo(page, QPoint(0, 0))
    return corner.x() + rect.left(), corner.x() + rect.right()


@pytest.mark.parametrize("mode", ["time", "distance"])
def test_stacked_plots_share_their_edges_to_the_pixel(page, mode):
    page._cursor.set_axis_mode(mode)
    seen = 0
    for theme in THEMES.values():
        page.apply_theme(theme)
        for size in SIZES:
            page.resize(*size)
            for arrangement in ("path", "sound", "leaks"):
                page.arrange(arrangement)
                page.layout().activate()
                shown = [v for v in (page.overview, page.spectrogram, page.level, page.imu) if v.isVisible()]
                assert len(shown) >= (3 if size == SIZES[0] else 1)
                assert len({edges(page, view) for view in shown}) == 1, (theme.name, size, arrangement)
                assert all(view.plot_rect().width() > 20 for view in shown)
                seen += len(shown) > 1
    assert seen >= 18


def test_one_moment_is_at_one_pixel_in_all_of_them(page):
    for mode in ("time", "distance"):
        page._cursor.set_axis_mode(mode)
        page._cursor.zoom(0.3, page._cursor.x_extent[1] / 2.0)
        page.arrange("leaks")
        page.layout().activate()
        for time_s in (20.0, 25.0, 31.0):
            shown = (page.spectrogram, page.level)
            at = [v.mapTo(page, QPoint(0, 0)).x() + v.pixel_of_time(time_s) for v in shown]
            assert at[0] == pytest.approx(at[1], abs=1e-9)


def test_the_edges_of_plots_in_the_tools_are_those_of_their_kind(page):
    """Whatever is drawn over the common axis takes its edges from its width and theme alone."""
    page.resize(*SIZES[0])
    plots = page.findChildren(PlotFrame)
    assert len(plots) > 5
    for plot in plots:
        plot.resize(500, 160)
        assert isinstance(plot, LinkedPlot)
    assert len({(p.plot_rect().left(), p.plot_rect().right()) for p in plots}) == 1
