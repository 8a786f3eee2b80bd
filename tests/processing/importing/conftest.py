"""Physically right IMU rows to write real-shaped logs from: what the accelerometer feels follows from the turn."""

import copy
import functools
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

GRAVITY = 9.80665


@dataclass
class Rows:
    """A device that rests, then tumbles, then rests: SI units, noise of a real sensor."""

    time: np.ndarray
    acc: np.ndarray
    gyr: np.ndarray
    mag: np.ndarray
    quat: np.ndarray

    def write(self, path, **columns):
        """Write the neutral form; ``columns`` replace or add columns by name."""
        table = {"time_s": self.time}
        for name, values, unit in (("acc", self.acc, "mps2"), ("gyr", self.gyr, "radps")):
            table |= {f"{name}_{axis}_{unit}": values[:, i] for i, axis in enumerate("xyz")}
        table |= columns
        write_table(path, table)
        return path


def write_table(path, table, separator=",", number="%.7f", encoding="utf-8", end="\n"):
    lines = [separator.join(table)]
    columns = [[number % v if isinstance(v, float) else str(v) for v in np.asarray(c).tolist()] for c in table.values()]
    lines += [separator.join(cells) for cells in zip(*columns, strict=True)]
    path.write_bytes((end.join(lines) + end).encode(encoding))


def make_rows(seconds=20.0, rate_hz=100.0, seed=1, spin=3.0, noise=True):
    """Rest for a quarter, tumble with up to ``spin`` rad/s, rest for a quarter."""
    return copy.deepcopy(_made(seconds, rate_hz, seed, spin, noise))


@functools.cache
def _made(seconds, rate_hz, seed, spin, noise):
    rng = np.random.default_rng(seed)
    time = np.arange(round(seconds * rate_hz)) / rate_hz
    phase = np.clip((time - seconds / 4) / (seconds / 2), 0, 1)
    swell = np.sin(np.pi * phase) ** 2
    omega = spin * swell[:, None] * np.column_stack([np.sin(1.3 * time + 1), np.cos(0.9 * time), np.sin(0.5 * time)])
    steps = Rotation.from_rotvec(omega / rate_hz)
    attitude = [Rotation.from_rotvec([0.2, -0.1, 0.3])]
    for step in steps[:-1]:
        attitude.append(attitude[-1] * step)
    attitude = Rotation.concatenate(attitude)
    acc = attitude.inv().apply([0.0, 0.0, GRAVITY])
    mag = attitude.inv().apply([0.0, 25.0, -40.0])
    if noise:
        acc = acc + rng.normal(0, 0.03, acc.shape)
        omega = omega + rng.normal(0, 0.003, acc.shape)
        mag = mag + rng.normal(0, 0.3, acc.shape)
    return Rows(time, acc, omega, mag, attitude.as_quat(scalar_first=True))


@pytest.fixture
def rows():
    return make_rows()


@pytest.fixture
def table():
    """The function that writes a table of columns."""
    return write_table


@pytest.fixture
def make():
    """The function that makes rows."""
    return make_rows
