"""On the plan only the broad stretch of what is in view is drawn anew while other views pan: nothing else has moved."""

from PySide6.QtGui import QColor

from widgets.path_view import PathView
from widgets.plot_theme import LIGHT


def wait_for_range(qtbot, view):
    qtbot.waitUntil(lambda: view._range_stale or not view._follow_range._timer.isActive())
    qtbot.waitUntil(lambda: not view._follow_range._timer.isActive())


def test_after_a_pan_of_the_others_the_plan_is_as_if_it_were_drawn_anew(cursor, track, shown, qtbot):
    view = shown(PathView(cursor), 500, 500)
    view.set_track(track)
    view.grab()
    for span in ((100.0, 200.0), (320.0, 420.0), (0.0, 90.0)):
        cursor.set_range(*span)
        wait_for_range(qtbot, view)
        kept = view.grab().toImage()
        inside = view.pixel_of_moment(sum(span) / 2.0).toPoint()
        outside = view.pixel_of_moment(550.0).toPoint()
        # beside the thin line of the path, but within the broad one
        assert kept.pixelColor(inside.x() + 3, inside.y() + 2) != QColor(LIGHT.canvas)
        assert kept.pixelColor(outside.x() + 3, outside.y() + 2) == QColor(LIGHT.canvas)
        view.invalidate()
        assert view.grab().toImage() == kept


def test_another_theme_draws_all_of_it_anew(cursor, track, shown):
    view = shown(PathView(cursor), 300, 300)
    view.set_track(track)
    before = view.grab().toImage()
    cursor.set_range(100.0, 150.0)
    view.apply_theme(LIGHT.scaled(1.4))
    assert view.grab().toImage() != before
