"""The inner loops of the streamed pass, compiled where a compiler built them; numpy does the same without one.

Cython in pure-Python mode. Twins in :mod:`processing.sound.plain_pass` state what each function does; these only do it
in one walk over the memory instead of five. Several sums side by side let the compiler use the wide registers.
"""
# mypy: ignore-errors

import cython

COMPILED: bool = cython.compiled


def cut_windows(
    samples: cython.const[cython.float][::1],
    start: cython.Py_ssize_t,
    hop: cython.Py_ssize_t,
    window: cython.const[cython.float][::1],
    out: cython.float[:, ::1],
) -> None:
    """Twin of :func:`processing.sound.plain_pass.cut_windows`."""
    n: cython.Py_ssize_t = out.shape[0]
    size: cython.Py_ssize_t = window.shape[0]
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    with cython.nogil:
        for i in range(n):
            at: cython.Py_ssize_t = start + i * hop
            for k in range(size):
                out[i, k] = samples[at + k] * window[k]


def pool_spectra(
    parts: cython.const[cython.float][:, ::1],
    bins_pooled: cython.Py_ssize_t,
    highest: cython.float[:, ::1],
    mean: cython.float[:, ::1],
    edges: cython.const[cython.Py_ssize_t][:, ::1],
    shares: cython.const[cython.float][:, ::1],
    inside: cython.float,
    bands: cython.float[:, ::1],
    scratch: cython.float[:, ::1],
) -> None:
    """Twin of :func:`processing.sound.plain_pass.pool_spectra`; ``scratch`` is (3, bins)."""
    columns: cython.Py_ssize_t = highest.shape[0]
    per_column: cython.Py_ssize_t = parts.shape[0] // columns
    bins: cython.Py_ssize_t = scratch.shape[1]
    column: cython.Py_ssize_t
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    with cython.nogil:
        for column in range(columns):
            for k in range(bins):
                scratch[1, k] = 0
                scratch[2, k] = 0
            for i in range(column * per_column, (column + 1) * per_column):
                for k in range(bins):
                    scratch[0, k] = parts[i, 2 * k] * parts[i, 2 * k] + parts[i, 2 * k + 1] * parts[i, 2 * k + 1]
                # each in a loop of its own: so simple that the compiler does four at once
                for k in range(bins):
                    scratch[1, k] += scratch[0, k]
                for k in range(bins):
                    scratch[2, k] = max(scratch[2, k], scratch[0, k])
                _band_sums(scratch[0], edges, shares, inside, bands[i])
            _pool_bins(scratch, bins_pooled, per_column * bins_pooled, highest[column], mean[column])


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _band_sums(
    power: cython.float[::1],
    edges: cython.const[cython.Py_ssize_t][:, ::1],
    shares: cython.const[cython.float][:, ::1],
    inside: cython.float,
    out: cython.float[::1],
) -> cython.void:
    """Sum the bins of each band, four sums side by side."""
    b: cython.Py_ssize_t
    for b in range(out.shape[0]):
        low: cython.Py_ssize_t = edges[b, 0]
        high: cython.Py_ssize_t = edges[b, 1]
        s0: cython.float = 0
        s1: cython.float = 0
        s2: cython.float = 0
        s3: cython.float = 0
        k: cython.Py_ssize_t = low
        while k + 4 <= high:
            s0 += power[k]
            s1 += power[k + 1]
            s2 += power[k + 2]
            s3 += power[k + 3]
            k += 4
        while k < high:
            s0 += power[k]
            k += 1
        out[b] = inside * ((s0 + s1) + (s2 + s3)) - power[low] * shares[b, 0] + power[high] * shares[b, 1]


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _pool_bins(
    scratch: cython.float[:, ::1],
    bins_pooled: cython.Py_ssize_t,
    count: cython.Py_ssize_t,
    highest: cython.float[::1],
    mean: cython.float[::1],
) -> cython.void:
    """Pool the sums and the highest values of the bins to rows; ``count`` values make a mean."""
    k: cython.Py_ssize_t
    i: cython.Py_ssize_t
    for k in range(highest.shape[0]):
        top: cython.float = scratch[2, k * bins_pooled]
        total: cython.float = scratch[1, k * bins_pooled]
        for i in range(k * bins_pooled + 1, (k + 1) * bins_pooled):
            top = max(top, scratch[2, i])
            total += scratch[1, i]
        highest[k] = top
        mean[k] = total / count


def frame_bands(
    bands: cython.const[cython.float][:, ::1],
    power: cython.float[:, ::1],
    ratio: cython.float[:, ::1],
    scratch: cython.float[::1],
) -> None:
    """Twin of :func:`processing.sound.plain_pass.frame_bands`; ``scratch`` holds a frame's windows."""
    frames: cython.Py_ssize_t = power.shape[0]
    count: cython.Py_ssize_t = power.shape[1]
    hops: cython.Py_ssize_t = bands.shape[0] // frames
    frame: cython.Py_ssize_t
    b: cython.Py_ssize_t
    i: cython.Py_ssize_t
    with cython.nogil:
        for frame in range(frames):
            for b in range(count):
                total: cython.float = 0
                for i in range(hops):
                    scratch[i] = bands[frame * hops + i, b]
                    total += scratch[i]
                _sort(scratch, hops)
                total /= hops
                middle: cython.float = scratch[(hops - 1) // 2]
                power[frame, b] = total
                ratio[frame, b] = total / middle if middle > 1e-30 else (1.0 if middle <= 0 else total / 1e-30)


def low_bands(
    parts: cython.const[cython.float][:, ::1],
    gain: cython.const[cython.float][::1],
    bins: cython.const[cython.Py_ssize_t][:, ::1],
    factor: cython.const[cython.float][::1],
    power: cython.float[:, ::1],
    ratio: cython.float[:, ::1],
    total: cython.float[::1],
    scratch: cython.float[:, ::1],
) -> None:
    """Twin of :func:`processing.sound.plain_pass.low_bands`; ``scratch`` is (2, bins)."""
    windows: cython.Py_ssize_t = parts.shape[0]
    count: cython.Py_ssize_t = bins.shape[0]
    size: cython.Py_ssize_t = gain.shape[0]
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    b: cython.Py_ssize_t
    with cython.nogil:
        for i in range(windows):
            for k in range(size):
                scratch[0, k] = gain[k] * (
                    parts[i, 2 * k] * parts[i, 2 * k] + parts[i, 2 * k + 1] * parts[i, 2 * k + 1]
                )
            for k in range(size):
                total[k] += scratch[0, k]
            for b in range(count):
                first: cython.Py_ssize_t = bins[b, 0]
                width: cython.Py_ssize_t = bins[b, 1] - first
                mean: cython.float = 0
                for k in range(width):
                    scratch[1, k] = scratch[0, first + k]
                    mean += scratch[1, k]
                mean /= width
                _sort(scratch[1], width)
                middle: cython.float = 0.5 * (scratch[1, (width - 1) // 2] + scratch[1, width // 2])
                power[i, b] = factor[b] * middle
                ratio[i, b] = mean / middle if middle > 1e-30 else (1.0 if middle <= 0 else mean / 1e-30)


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _sort(values: cython.float[::1], count: cython.Py_ssize_t) -> cython.void:
    """Sort the first few: there are never more than some dozens."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    v: cython.float
    for i in range(1, count):
        v = values[i]
        j = i - 1
        while j >= 0 and values[j] > v:
            values[j + 1] = values[j]
            j -= 1
        values[j + 1] = v


def halve(samples: cython.const[cython.float][::1], out: cython.float[::1]) -> None:
    """Twin of :func:`processing.sound.plain_pass.halve`."""
    n: cython.Py_ssize_t = out.shape[0]
    i: cython.Py_ssize_t
    outer: cython.float = 0.125
    inner: cython.float = 0.375
    with cython.nogil:
        for i in range(n):
            out[i] = outer * (samples[2 * i] + samples[2 * i + 3]) + inner * (samples[2 * i + 1] + samples[2 * i + 2])


def onset_energy(
    samples: cython.const[cython.float][::1],
    start: cython.Py_ssize_t,
    lag: cython.Py_ssize_t,
    out: cython.float[::1],
    step: cython.Py_ssize_t,
) -> None:
    """Twin of :func:`processing.sound.plain_pass.onset_energy`."""
    n: cython.Py_ssize_t = out.shape[0]
    whole: cython.Py_ssize_t = step // 4 * 4
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    sums = cython.declare(cython.float[4])
    two: cython.float = 2
    sharp: cython.float
    with cython.nogil:
        for i in range(n):
            at: cython.Py_ssize_t = start + i * step
            for j in range(4):
                sums[j] = 0
            for k in range(0, whole, 4):
                for j in range(4):
                    sharp = samples[at + k + j] - two * samples[at + k + j - lag] + samples[at + k + j - 2 * lag]
                    sums[j] += sharp * sharp
            for k in range(whole, step):
                sharp = samples[at + k] - two * samples[at + k - lag] + samples[at + k - 2 * lag]
                sums[0] += sharp * sharp
            out[i] = ((sums[0] + sums[1]) + (sums[2] + sums[3])) / step


def envelope(
    samples: cython.const[cython.float][::1],
    start: cython.Py_ssize_t,
    block: cython.Py_ssize_t,
    out: cython.float[:, ::1],
) -> None:
    """Twin of :func:`processing.sound.plain_pass.envelope`; ``block`` is a multiple of eight."""
    n: cython.Py_ssize_t = out.shape[0]
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    low = cython.declare(cython.float[8])
    high = cython.declare(cython.float[8])
    total = cython.declare(cython.float[8])
    square = cython.declare(cython.float[8])
    v: cython.float
    nothing: cython.float = 0
    with cython.nogil:
        for i in range(n):
            at: cython.Py_ssize_t = start + i * block
            first: cython.float = samples[at]
            for j in range(8):
                low[j] = 0
                high[j] = 0
                total[j] = 0
                square[j] = 0
            for k in range(0, block, 8):
                for j in range(8):
                    v = samples[at + k + j] - first
                    low[j] = min(low[j], v)
                    high[j] = max(high[j], v)
                    total[j] += v
                    square[j] += v * v
            for j in range(1, 8):
                low[0] = min(low[0], low[j])
                high[0] = max(high[0], high[j])
                total[0] += total[j]
                square[0] += square[j]
            offset: cython.float = total[0] / block
            spread: cython.float = square[0] / block - offset * offset
            out[i, 0] = first + low[0]
            out[i, 1] = first + high[0]
            out[i, 2] = first + offset
            out[i, 3] = max(spread, nothing)
