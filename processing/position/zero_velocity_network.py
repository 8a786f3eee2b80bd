"""Learned standstill detection without a learning library: the networks' weights, checked, and their forward pass.

Two networks are shipped as plain arrays (``resources/zero_velocity/*.npz``, written by
``packaging/train_zero_velocity.py``): ``lstm``, the recurrent one of P4 (6 layers of 80 units, raw 6 channels), and
``tcn``, a small stack of dilated convolutions over inputs that no mounting of the sensor changes, which looks ahead
as well as back. Both work at 200 Hz, and both say what they were trained on.
"""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

import numpy as np
import numpy.typing as npt

Float32Array = npt.NDArray[np.float32]

RATE_HZ = 200.0
NAMES = ("lstm", "tcn")
_GRAVITY = 9.80665
_STREAMS = 64  # sequences side by side: one row of a matrix product each
_WARM_UP = 100  # samples before its own that a stream has seen: P4's window
_BLOCK = 32_768
_LARGEST = 4_000_000  # values in a file of weights: no more is read


@dataclass(frozen=True)
class Network:
    """``kind`` lstm or tcn, its ``arrays`` by name (float32), and the ``record`` of its training."""

    kind: str
    arrays: dict[str, Float32Array]
    record: dict[str, Any]

    @property
    def layers(self) -> int:
        """How many layers come before the last, dense one."""
        return sum(name.startswith("weight_ih_" if self.kind == "lstm" else "kernel_") for name in self.arrays)

    @property
    def threshold(self) -> float:
        """The probability from which it stands (P4: 0.85)."""
        return float(self.record["threshold"])


def load_network(name: str) -> Network:
    """Return the shipped network ``lstm`` or ``tcn``.

    Raises:
        ValueError: for a name that is not in :data:`NAMES`, or a file whose arrays do not fit together.
    """
    if name not in NAMES:
        raise ValueError(name)
    with (files("resources") / "zero_velocity" / f"{name}.npz").open("rb") as file:
        return checked(np.load(file, allow_pickle=False))


def checked(stored: Any) -> Network:  # noqa: ANN401  # numpy's NpzFile or a dict of arrays
    """Return the network held by ``stored`` arrays; shapes must fit from layer to layer.

    Raises:
        ValueError: with what is wrong.
    """
    record = json.loads(str(stored["record"]))
    arrays = {name: np.asarray(stored[name], dtype=np.float32) for name in stored if name != "record"}
    if sum(a.size for a in arrays.values()) > _LARGEST or not all(np.all(np.isfinite(a)) for a in arrays.values()):
        raise ValueError("weights are too many or not finite")
    network = Network(str(record["kind"]), arrays, record)
    width = 6 if network.kind == "lstm" else FEATURES
    for name, shape in _shapes(network, width):
        if name not in arrays or arrays[name].shape != shape:
            raise ValueError(f"{name} should have shape {shape}")
    if not 0.0 < network.threshold < 1.0:
        raise ValueError("threshold")
    return network


def _shapes(network: Network, width: int) -> Iterator[tuple[str, tuple[int, ...]]]:
    if network.kind not in NAMES or network.layers == 0:
        raise ValueError(f"unknown kind {network.kind}")
    yield "input_scale", (width,)
    for k in range(network.layers):
        if network.kind == "lstm":
            units = int(network.arrays[f"weight_ih_{k}"].shape[0]) // 4
            yield f"weight_ih_{k}", (4 * units, width)
            yield f"weight_hh_{k}", (4 * units, units)
            yield f"bias_{k}", (4 * units,)
        else:
            taps, _, units = network.arrays[f"kernel_{k}"].shape
            yield f"kernel_{k}", (taps, width, units)
            yield f"bias_{k}", (units,)
        width = units
    yield "dense", (2, width)
    yield "dense_bias", (2,)


FEATURES = 7


def features(acc_mps2: Float32Array, gyr_radps: Float32Array) -> Float32Array:
    """Return what the convolutions see (n, 7) of both (n, 3) at 200 Hz: sizes and changes that no mounting alters.

    In order: |a| − g; |ω|; how far a and ω are from their means over 55 ms; the part of a along its mean over half a
    second less g, and the part across it; the change of ω over two samples. Each squeezed by asinh.
    """
    from scipy.ndimage import uniform_filter1d

    def mean(values: Float32Array, width: int) -> Float32Array:
        return np.asarray(uniform_filter1d(values, width, axis=0, mode="nearest"), dtype=np.float32)

    def size(values: Float32Array) -> Float32Array:
        return np.asarray(np.sqrt(np.einsum("ij,ij->i", values, values)), dtype=np.float32)

    slow = mean(acc_mps2, 101)
    down = slow / np.maximum(size(slow), 1e-3)[:, None]
    along = np.einsum("ij,ij->i", acc_mps2, down)
    change = np.zeros_like(gyr_radps)
    change[1:-1] = gyr_radps[2:] - gyr_radps[:-2]
    table = np.column_stack(
        [
            (size(acc_mps2) - _GRAVITY) / 0.5,
            size(gyr_radps) / 0.3,
            size(acc_mps2 - mean(acc_mps2, 11)) / 0.3,
            size(gyr_radps - mean(gyr_radps, 11)) / 0.1,
            (along - _GRAVITY) / 0.5,
            size(acc_mps2 - along[:, None] * down) / 0.5,
            size(change) / 0.1,
        ]
    )
    return np.asarray(np.arcsinh(table), dtype=np.float32)


def standing_probability(
    network: Network,
    acc_mps2: Float32Array,
    gyr_radps: Float32Array,
    tick: Callable[[float], None] = lambda _: None,
) -> Float32Array:
    """Return the probability of standing (n,) at each sample of both (n, 3), which are uniform at 200 Hz.

    The LSTM has seen at least the 100 samples before (P4's window); the convolutions see 62 on both sides.
    ``tick`` is told the fraction done. Source: P4 equations (IV)–(IX); van den Oord et al. 2016 (dilated convolution).
    """
    if network.kind == "lstm":
        return _recurrent(network, np.column_stack([acc_mps2, gyr_radps]).astype(np.float32), tick)
    out = np.empty(len(acc_mps2), dtype=np.float32)
    margin = _reach(network) + 51  # the features' own reach
    for start in range(0, len(acc_mps2), _BLOCK):
        first, last = max(start - margin, 0), min(start + _BLOCK + margin, len(acc_mps2))
        values = _convolved(network, features(acc_mps2[first:last], gyr_radps[first:last]))
        out[start : start + _BLOCK] = values[start - first : start - first + _BLOCK]
        tick(min(start + _BLOCK, len(out)) / len(out))
    return out


def _reach(network: Network) -> int:
    return sum((network.arrays[f"kernel_{k}"].shape[0] // 2) * 2**k for k in range(network.layers))


def _convolved(network: Network, inputs: Float32Array) -> Float32Array:
    """Layer k: taps 2ᵏ samples apart, zeros beyond the ends, negative values cut."""
    x = inputs * network.arrays["input_scale"]
    for k in range(network.layers):
        kernel = network.arrays[f"kernel_{k}"]
        taps, width, units = kernel.shape
        reach = (taps // 2) * 2**k
        padded = np.zeros((len(x) + 2 * reach, width), dtype=np.float32)
        padded[reach : reach + len(x)] = x
        side_by_side = np.concatenate([padded[t * 2**k : t * 2**k + len(x)] for t in range(taps)], axis=1)
        x = np.maximum(side_by_side @ kernel.reshape(taps * width, units) + network.arrays[f"bias_{k}"], 0.0)
    return _softmax(network, x)


def _softmax(network: Network, x: Float32Array) -> Float32Array:
    """The second of two classes: 1 / (1 + exp(z₀ − z₁))."""
    z = x @ network.arrays["dense"].T + network.arrays["dense_bias"]
    return np.asarray(_sigmoid(z[..., 1] - z[..., 0]), dtype=np.float32)


def _sigmoid(x: Float32Array) -> Float32Array:
    return np.asarray(np.float32(0.5) * (np.tanh(np.float32(0.5) * x) + np.float32(1.0)), dtype=np.float32)


def _recurrent(network: Network, inputs: Float32Array, tick: Callable[[float], None]) -> Float32Array:
    """Run pieces of the recording side by side, each from the zero state _WARM_UP samples before its own part."""
    own = max(4 * _WARM_UP, 1)
    out = np.empty(len(inputs), dtype=np.float32)
    padded = np.concatenate([np.zeros((_WARM_UP, 6), np.float32), inputs * network.arrays["input_scale"]])
    starts = np.arange(0, len(inputs), own)
    for at in range(0, len(starts), _STREAMS):
        part = starts[at : at + _STREAMS]
        rows = np.minimum(part[None, :] + np.arange(_WARM_UP + own)[:, None], len(padded) - 1)
        # the first piece begins with the recording itself, not with padding
        probability = _streams(network, padded[rows], fresh_until=_WARM_UP if at == 0 else 0)[_WARM_UP:]
        for column, start in enumerate(part):
            count = min(own, len(out) - start)
            out[start : start + count] = probability[:count, column]
        tick(min(at + _STREAMS, len(starts)) / len(starts))
    return out


def _streams(network: Network, x: Float32Array, fresh_until: int) -> Float32Array:
    """Probabilities (steps, streams) of inputs (steps, streams, 6); stream 0 starts anew after ``fresh_until`` steps.

    Gates in the order input, forget, node, output.
    """
    steps, streams = x.shape[:2]
    for k in range(network.layers):
        recurrent = np.ascontiguousarray(network.arrays[f"weight_hh_{k}"].T)
        units = recurrent.shape[0]
        pushed = x.reshape(steps * streams, -1) @ network.arrays[f"weight_ih_{k}"].T + network.arrays[f"bias_{k}"]
        pushed = pushed.reshape(steps, streams, 4 * units)
        h, s = np.zeros((streams, units), np.float32), np.zeros((streams, units), np.float32)
        x = np.empty((steps, streams, units), np.float32)
        for step in range(steps):
            if step == fresh_until:
                h[0], s[0] = 0.0, 0.0
            gates = pushed[step] + h @ recurrent
            i, f, o = (_sigmoid(gates[:, n * units : (n + 1) * units]) for n in (0, 1, 3))
            s = f * s + i * np.tanh(gates[:, 2 * units : 3 * units])
            h = o * np.tanh(s)
            x[step] = h
    return _softmax(network, x)
