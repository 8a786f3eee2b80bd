import numpy as np
import pytest

from widgets.spectrogram_view import SpectrogramView
from widgets.tile_source import mean_levels


class EvenTiles:
    """Sound of one level, in tenths of a second."""

    low_db, step_db, start_s, hop_s = -130.0, 0.5, 0.0, 0.1

    def __init__(self, end_s=600.0, bins=65):
        self.end_s = end_s
        self.frequencies_hz = np.linspace(0.0, 8000.0, bins)

    def columns(self, start_s, end_s, columns, plane="max"):
        return np.full((len(self.frequencies_hz), columns), 60, np.uint8)


@pytest.fixture
def view(cursor, shown):
    view = shown(SpectrogramView(cursor), 1000, 300)
    yield view
    view.set_source(None)


def sharp(qtbot, view):
    qtbot.waitUntil(lambda: bool(view.grab()) and view.is_sharp)


class NoiseTiles(EvenTiles):
    """Noise of a level that rises along the way, with a steady sound 6 dB over it from 300 to 320 s at 2 to 4 kHz."""

    def __init__(self):
        super().__init__()
        power = np.random.default_rng(8).exponential(1.0, (65, 6000))
        ground = 10.0 ** np.linspace(0.0, 1.0, 6000)  # 10 dB over the whole run
        power *= ground
        power[16:33, 3000:3200] *= 4.0
        self.power = power

    def columns(self, start_s, end_s, columns, plane="max"):
        edges = np.linspace(start_s, end_s, columns + 1) / self.hop_s
        out = np.zeros((len(self.frequencies_hz), columns), np.uint8)
        for k in range(columns):
            a = int(np.clip(np.floor(edges[k] + 1e-9), 0, self.power.shape[1] - 1))
            b = int(np.clip(np.ceil(edges[k + 1] - 1e-9), a + 1, self.power.shape[1]))
            if edges[k + 1] > 0 and edges[k] < self.power.shape[1]:
                piece = self.power[:, a:b]
                pooled = piece.max(axis=1) if plane == "max" else piece.mean(axis=1)
                out[:, k] = np.clip(np.rint((10 * np.log10(pooled) - 80.0 + 130.0) / 0.5), 1, 255)
        return out


def mean_level(view, low_s, high_s, low_hz, high_hz):
    key, levels = view._picture.key, view._picture.levels
    rows = 1.0 - key.frequency.fraction(np.array([high_hz, low_hz]))
    first, last = (rows * key.rows).astype(int)
    left, right = ((np.array([low_s, high_s]) - key.x_low) / (key.x_high - key.x_low) * key.columns).astype(int)
    return np.median([view._level_of(int(n)) for n in levels[first:last, left:right].ravel()])


def test_steady_sounds_are_hidden_in_the_maxima_and_plain_in_the_means(cursor, view, qtbot):
    cursor.set_track(None)
    cursor.set_extent(0.0, 600.0)
    view.set_frequency_scale("linear")
    view.set_source(NoiseTiles())
    found = {}
    for plane in ("max", "mean"):
        view.set_plane(plane)
        sharp(qtbot, view)
        found[plane] = mean_level(view, 340.0, 360.0, 2100.0, 3900.0)
    true = -80.0 + 10.0 * 350.0 / 600.0
    assert found["mean"] == pytest.approx(true, abs=0.7)
    assert found["max"] > true + 2.0


@pytest.mark.parametrize("zoom", [1.0, 0.3])
def test_the_excess_view_takes_a_slowly_changing_background_away(cursor, view, qtbot, zoom):
    cursor.set_track(None)
    cursor.set_extent(0.0, 600.0)
    cursor.zoom(zoom, 310.0)
    view.set_frequency_scale("linear")
    view.set_plane("excess")
    view.set_source(NoiseTiles())
    sharp(qtbot, view)
    for start, want in ((302.0, 6.0), (345.0, 0.0), (260.0, 0.0)):
        assert mean_level(view, start, start + 16.0, 2100.0, 3900.0) == pytest.approx(want, abs=0.9)
    low, high = view.db_range
    assert low == -high  # the neutral colour is the background itself


def test_the_means_of_uneven_columns_are_means_of_power_and_pass_over_what_is_not_there():
    levels = np.array([[100, 120, 0, 0, 140, 140]], np.uint8)
    found = mean_levels(levels, np.array([0, 2, 3]), np.array([2, 4, 6]), 0.5, axis=1)
    expected = 10 * np.log10((10**5.0 + 10**6.0) / 2) / 0.5
    assert found.tolist() == [[round(expected), 0, 140]]


def test_the_looks_stay_when_another_sound_is_shown_and_the_range_that_was_chosen_too(view, qtbot):
    view.set_source(EvenTiles())
    view.set_frequency_scale("mel")
    view.set_plane("mean")
    view.set_color_map("grey")
    view.set_db_range(-100.0, -50.0)
    view.set_source(EvenTiles(end_s=300.0))
    assert (view.frequency_scale, view.plane, view.color_map, view.db_range) == ("mel", "mean", "grey", (-100.0, -50.0))


def test_the_logarithmic_axis_reaches_from_fifty_hertz_to_the_top(view):
    view.set_source(EvenTiles())
    assert view.frequency_scale == "log"
    assert view.frequency_range == pytest.approx((62.5, 8000.0))  # bins 125 Hz apart know nothing lower
    view.set_source(EvenTiles(bins=801))
    assert view.frequency_range == (50.0, 8000.0)


@pytest.mark.parametrize("mode", ["time", "distance"])
@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (0.2, 0.45), (0.3, 0.302), (0.24, 0.26)])
def test_edges_of_any_span_are_those_of_the_visible_range(cursor, mode, low, high):
    cursor.set_axis_mode(mode)
    first, last = cursor.x_extent
    span = (first + low * (last - first), first + high * (last - first))
    asked = cursor.edges_s(*span, 50)
    cursor.set_x_range(*span)
    np.testing.assert_allclose(asked, cursor.column_edges_s(50), atol=1e-6)
    assert np.all(np.diff(asked) >= 0.0)
