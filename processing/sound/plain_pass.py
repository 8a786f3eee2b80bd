"""The inner loops of the streamed pass in numpy: what they mean, and what runs where no compiler built the kernels.

Functions write into arrays that they are given, all float32; :mod:`processing.sound.kernels_pass` has the same ones.
"""

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]
Places = npt.NDArray[np.intp]

_NOTHING = np.float32(1e-30)


def cut_windows(samples: Floats, start: int, hop: int, window: Floats, out: Floats) -> None:
    """Put the windows that begin at ``start + i·hop`` into ``out`` (n, size), weighted by ``window`` (size,)."""
    piece = samples[start : start + (len(out) - 1) * hop + len(window)]
    np.multiply(np.lib.stride_tricks.sliding_window_view(piece, len(window))[::hop], window, out=out)


def pool_spectra(
    parts: Floats,
    bins_pooled: int,
    highest: Floats,
    mean: Floats,
    edges: Places,
    shares: Floats,
    inside: float,
    bands: Floats,
    scratch: Floats,
) -> None:
    """Make of spectra what the pass keeps of them.

    Args:
        parts: (n, 2·bins) real and imaginary parts in turn.
        bins_pooled: bins that share a row of the picture; those beyond the last whole row are left out.
        highest: out (columns, rows), the highest power in each of equal groups of windows and of bins.
        mean: out (columns, rows), the mean power there.
        edges: (b, 2) first bin of each band and the one after its last whole one.
        shares: (b, 2) how much of the bins at ``edges`` to take away and to add: bands end within bins.
        inside: what the whole bins count.
        bands: out (n, b), power of each band in each window.
        scratch: not used here.
    """
    del scratch
    power = np.square(parts[:, ::2]) + np.square(parts[:, 1::2])
    columns, rows = highest.shape
    by_column = power[:, : rows * bins_pooled].reshape(columns, -1, rows * bins_pooled)
    shape = (columns, rows, bins_pooled)
    highest[:] = by_column.max(axis=1).reshape(shape).max(axis=2)
    mean[:] = by_column.mean(axis=1).reshape(shape).mean(axis=2)
    if len(edges):
        sums = np.add.reduceat(power, edges.ravel(), axis=1)[:, ::2] * np.float32(inside)
        sums[:, edges[:, 0] == edges[:, 1]] = 0  # reduceat gives the first element of an empty range
        sums -= power[:, edges[:, 0]] * shares[:, 0]
        bands[:] = sums + power[:, edges[:, 1]] * shares[:, 1]


def frame_bands(bands: Floats, power: Floats, ratio: Floats, scratch: Floats) -> None:
    """Put mean, and mean over lower median, of ``bands`` (frames·hops, b) in each frame into two (frames, b)."""
    del scratch
    by_frame = bands.reshape(len(power), -1, bands.shape[1])
    power[:] = by_frame.mean(axis=1)
    middle = (by_frame.shape[1] - 1) // 2
    ratio[:] = _ratio(power, np.sort(by_frame, axis=1)[:, middle])


def low_bands(
    parts: Floats,
    gain: Floats,
    bins: Places,
    factor: Floats,
    power: Floats,
    ratio: Floats,
    total: Floats,
    scratch: Floats,
) -> None:
    """Put ``factor`` · median over bins, and mean over median, of each low band into ``power`` and ``ratio`` (n, b).

    ``parts`` (n, 2·size) is as in :func:`pool_spectra`, ``gain`` (size,) corrects the power, ``bins`` (b, 2) are first
    and end bin of each band; each window's power is added to ``total`` (size,).
    """
    del scratch
    spectra = (np.square(parts[:, ::2]) + np.square(parts[:, 1::2]))[:, : len(gain)] * gain
    total += spectra.sum(axis=0)
    for band, (first, end) in enumerate(bins):
        middle = np.median(spectra[:, first:end], axis=1)
        power[:, band] = factor[band] * middle
        ratio[:, band] = _ratio(spectra[:, first:end].mean(axis=1), middle)


def halve(samples: Floats, out: Floats) -> None:
    """Put every other sample, smoothed with the weights 1 3 3 1, into ``out`` (len(samples)//2 − 1,).

    The triple zero of these weights lies where aliases of 0 Hz would come from: what folds onto the bands below 1 kHz
    is damped by 50 dB and more.
    """
    pairs = len(out)
    outer = samples[0 : 2 * pairs : 2] + samples[3 : 3 + 2 * pairs : 2]
    inner = samples[1 : 1 + 2 * pairs : 2] + samples[2 : 2 + 2 * pairs : 2]
    out[:] = np.float32(0.125) * outer + np.float32(0.375) * inner


def onset_energy(samples: Floats, start: int, lag: int, out: Floats, step: int) -> None:
    """Put the mean square of the second difference over ``lag`` samples into ``out``, one value each ``step``."""
    count = len(out) * step
    late, middle, early = (samples[start - k * lag : start - k * lag + count] for k in (0, 1, 2))
    sharp = ((late - middle) - (middle - early)).reshape(-1, step)
    out[:] = np.einsum("ij,ij->i", sharp, sharp) / np.float32(step)


def envelope(samples: Floats, start: int, block: int, out: Floats) -> None:
    """Put lowest, highest, mean and variance of each ``block`` samples from ``start`` on into ``out`` (n, 4)."""
    blocks = samples[start : start + len(out) * block].reshape(-1, block)
    out[:, 0], out[:, 1] = blocks.min(axis=1), blocks.max(axis=1)
    away = blocks - blocks[:, :1]  # a steady voltage is large and would eat up the digits of what is heard
    offset = away.mean(axis=1)
    out[:, 2] = blocks[:, 0] + offset
    out[:, 3] = np.maximum(np.einsum("ij,ij->i", away, away) / np.float32(block) - offset * offset, 0)


def _ratio(high: Floats, low: Floats) -> Floats:
    """Return high/low, 1 where there is nothing."""
    ratio: Floats = np.where(low > 0, high / np.maximum(low, _NOTHING), np.float32(1))
    return ratio
