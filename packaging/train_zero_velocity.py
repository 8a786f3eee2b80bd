#!/usr/bin/env python3
"""Trains the two networks that tell a foot's standstill from its motion, and writes their weights as plain arrays.

    python packaging/train_zero_velocity.py tcn  FOLDER resources/zero_velocity/tcn.npz
    python packaging/train_zero_velocity.py lstm FOLDER resources/zero_velocity/lstm.npz

Needs PyTorch 2.13, NumPy and SciPy in an environment of its own (``pip install torch==2.13.0 numpy scipy``), and this
repository on PYTHONPATH. The program itself never needs PyTorch.

**Data.** FOLDER holds the 56 processed VICON trials of the University of Toronto foot-mounted data set (IEEE DataPort;
B. Wagstaff, V. Peretroukhin, J. Kelly, "Robust Data-Driven Zero-Velocity Detection", IEEE Sensors Journal 2019):
``*.mat`` with ``imu`` (n, 6; m/s², rad/s, 200 Hz) and, for five threshold detectors, the labels ``zv_*_opt`` of the
threshold that gives the least position error against the cameras. A trial's label here is that of SHOE or of the
angular-rate energy, whichever was better (``trial_error``); a trial with more than 80 % standstill is left out, since
nobody walked. Trained on the sessions of 2017-11-22, 2017-11-27 and 2018-02-09; the sessions of 2017-12-15 and
2018-02-22 (12 trials) are never seen in training, and the best step is chosen on every sixth of the training trials.

**Recipe of P4** (Şahin, Ulamış 2023; after Wagstaff, Kelly 2018): windows of 100 samples, random rotation of the
sensor, scale 0.9 to 1.1, noise of 0.075 on each channel (m/s² and rad/s), cross-entropy, Adam; 6 layers of 80 units, a
dense layer to two classes, softmax. Departures: every step of a window past its 20th is labelled, not only the last,
which does in minutes what P4's 300 epochs of 420,000 windows do in days; acceleration is divided by 10 and rate by 2.
The convolutions (``tcn``) also see slower sensors (a low-pass at 25 to 90 Hz), a quicker or slower gait (0.8 to 1.25),
gyro offsets of 1 °/s and more or less noise, since they are meant for other sensors than the one they are trained on.

The file holds the arrays, a JSON ``record`` of all this with the accuracies reached, and a short input with PyTorch's
own output for it, by which the tests check the forward pass. Weights are rounded to half precision before that.
"""

from __future__ import annotations

import argparse
import itertools
import json
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from processing.position.zero_velocity_network import features

TRAIN_SESSIONS = ("2017-11-22", "2017-11-27", "2018-02-09")
TEST_SESSIONS = ("2017-12-15", "2018-02-22")
DETECTORS = ("shoe", "ared", "amvd", "mbgtd", "vicon")  # the order of trial_error
INPUT_SCALE = {"lstm": [0.1] * 3 + [0.5] * 3, "tcn": [0.5] * 7}


@dataclass(frozen=True)
class Trial:
    """``imu`` (n, 6) float32 at 200 Hz and ``still`` (n,) of one recording."""

    name: str
    imu: np.ndarray
    still: np.ndarray


def read_trials(folder: Path, sessions: tuple[str, ...]) -> list[Trial]:
    """Return the walked trials of the sessions."""
    from scipy.io import loadmat

    trials = []
    for path in sorted(folder.glob("*.mat")):
        if not path.name.startswith(sessions):
            continue
        stored = loadmat(path)
        errors = np.ravel(stored["trial_error"])[:2]
        label = np.ravel(stored[f"zv_{DETECTORS[int(np.argmin(errors))]}_opt"]).astype(np.float32)
        if np.mean(label) < 0.8:
            trials.append(Trial(path.stem, stored["imu"].astype(np.float32), label))
    return trials


def random_rotation(rng: np.random.Generator) -> np.ndarray:
    """Return a rotation matrix, all being equally likely."""
    q = rng.standard_normal(4)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ],
        dtype=np.float32,
    )


def window_of(trial: Trial, length: int, rng: np.random.Generator, *, hard: bool) -> tuple[np.ndarray, np.ndarray]:
    """One augmented window (length, 6) and its labels (length,)."""
    pace = rng.uniform(0.8, 1.25) if hard else 1.0
    need = int(np.ceil(length * pace)) + 2
    start = int(rng.integers(0, max(len(trial.imu) - need, 1)))
    part, label = trial.imu[start : start + need], trial.still[start : start + need]
    if hard:
        at = np.linspace(0.0, len(part) - 1.0, length)
        below = np.minimum(at.astype(int), len(part) - 2)
        share = (at - below)[:, None].astype(np.float32)
        part = part[below] * (1 - share) + part[below + 1] * share
        part[:, 3:] *= pace
        label = label[np.minimum(np.round(at).astype(int), len(label) - 1)]
        if rng.random() < 0.5:
            part = slower_sensor(part, rng)
        noise = rng.uniform(0.0, 0.1) * np.array([1.0] * 3 + [0.2] * 3)
        part[:, 3:] += np.radians(rng.normal(0.0, 1.0, 3)).astype(np.float32)
    else:
        part, label = part[:length].copy(), label[:length]
        noise = np.full(6, 0.075)
    turn = random_rotation(rng)
    part = np.column_stack([part[:, :3] @ turn.T, part[:, 3:] @ turn.T])
    # what is slower is weaker, but gravity stays: P4 scales it all the same, the convolutions only a hundredth of that
    part = part * (rng.uniform(0.9, 1.1) if not hard else rng.uniform(0.99, 1.01))
    return (part + rng.standard_normal(part.shape) * noise).astype(np.float32), label


def slower_sensor(part: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """As a sensor of 50 to 180 Hz would have recorded it, drawn out to 200 Hz again."""
    every = 200.0 / rng.uniform(50.0, 180.0)
    width = max(round(every), 1)
    smooth = np.column_stack(
        [np.convolve(np.pad(c, width, mode="edge"), np.ones(width) / width, "same") for c in part.T]
    )
    smooth = smooth[width:-width]
    at = np.arange(rng.uniform(0.0, every), len(part) - 1.0, every)
    seen = smooth[np.round(at).astype(int)]
    return np.column_stack([np.interp(np.arange(len(part)), at, c) for c in seen.T]).astype(np.float32)


def build(kind: str):  # noqa: ANN201  # a torch module: torch is imported only here
    """Return the network ``kind``, untrained."""
    import torch
    from torch import nn

    class Recurrent(nn.Module):
        def __init__(self) -> None:
            super().__init__()
            self.lstm = nn.LSTM(6, 80, 6, batch_first=True)
            self.dense = nn.Linear(80, 2)
            for name, value in self.lstm.named_parameters():
                if name.startswith("weight_hh"):
                    for gate in value.data.chunk(4):
                        nn.init.orthogonal_(gate)
                elif name.startswith("weight_ih"):
                    nn.init.xavier_uniform_(value.data)
                elif name.startswith("bias_ih"):
                    value.data.zero_()
                    value.data[80:160] = 1.0  # remember at first
                else:
                    value.data.zero_()

        def forward(self, x: torch.Tensor) -> torch.Tensor:
            return self.dense(self.lstm(x)[0])

    class Convolutional(nn.Module):
        def __init__(self) -> None:
            super().__init__()
            widths = [7, 24, 24, 24, 24, 24]
            self.convs = nn.ModuleList(
                nn.Conv1d(a, b, 5, dilation=2**k, padding=2 * 2**k)
                for k, (a, b) in enumerate(itertools.pairwise(widths))
            )
            self.dense = nn.Linear(24, 2)

        def forward(self, x: torch.Tensor) -> torch.Tensor:
            x = x.transpose(1, 2)
            for conv in self.convs:
                x = torch.relu(conv(x))
            return self.dense(x.transpose(1, 2))

    return Recurrent() if kind == "lstm" else Convolutional()


def inputs_of(kind: str, imu: np.ndarray) -> np.ndarray:
    """Return what the network sees (n, k) of a recording."""
    seen = imu if kind == "lstm" else features(imu[:, :3], imu[:, 3:])
    return (seen * np.array(INPUT_SCALE[kind], dtype=np.float32)).astype(np.float32)


def accuracy(kind: str, model, trials: list[Trial]) -> dict[str, float]:  # noqa: ANN001
    """Share of samples as labelled, at 0.5; of standstill, how much is found; of what is found, how much is one."""
    import torch

    hits = total = both = found = real = 0
    with torch.no_grad():
        for trial in trials:
            logits = model(torch.from_numpy(inputs_of(kind, trial.imu))[None])[0]
            guess = (logits[:, 1] > logits[:, 0]).numpy()
            true = trial.still > 0.5
            hits, total = hits + int(np.sum(guess == true)), total + len(true)
            both, found, real = both + int(np.sum(guess & true)), found + int(np.sum(guess)), real + int(np.sum(true))
    return {"accuracy": hits / total, "recall": both / max(real, 1), "precision": both / max(found, 1)}


def train(kind: str, folder: Path, steps: int, seed: int):  # noqa: ANN201
    """Return the trained model, and the trials it was trained and chosen on."""
    import torch

    torch.manual_seed(seed)
    torch.set_num_threads(1)
    rng = np.random.default_rng(seed)
    trials = read_trials(folder, TRAIN_SESSIONS)
    held = trials[::6]
    seen = [t for t in trials if t not in held]
    weights = np.array([len(t.imu) for t in seen], dtype=float)
    model = build(kind)
    length, batch, first = (100, 64, 20) if kind == "lstm" else (400, 32, 0)
    optimiser = torch.optim.Adam(model.parameters(), lr=1e-3)
    top = 3e-3
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, top, total_steps=steps, pct_start=0.15)
    best, best_state, began = 0.0, None, time.time()
    for step in range(steps):
        picked = rng.choice(len(seen), batch, p=weights / weights.sum())
        pairs = [window_of(seen[i], length, rng, hard=kind == "tcn") for i in picked]
        x = torch.from_numpy(np.stack([inputs_of(kind, p[0]) for p in pairs]))
        y = torch.from_numpy(np.stack([p[1] for p in pairs])).long()
        loss = torch.nn.functional.cross_entropy(model(x)[:, first:].reshape(-1, 2), y[:, first:].reshape(-1))
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimiser.step()
        schedule.step()
        if step % 100 == 99 or step == steps - 1:
            now = accuracy(kind, model, held)
            print(f"step {step + 1} loss {loss.item():.4f} held {now} {time.time() - began:.0f} s", flush=True)
            if now["accuracy"] > best:
                best, best_state = now["accuracy"], {k: v.clone() for k, v in model.state_dict().items()}
    model.load_state_dict(best_state)
    return model, seen, held


def arrays_of(kind: str, model) -> dict[str, np.ndarray]:  # noqa: ANN001
    """The weights by the names the program knows, rounded to half precision, and the model set to the same."""
    import torch

    with torch.no_grad():
        for value in model.parameters():
            value.copy_(value.half().float())
        if kind == "lstm":  # one bias instead of two
            for k in range(6):
                one, two = getattr(model.lstm, f"bias_ih_l{k}"), getattr(model.lstm, f"bias_hh_l{k}")
                one.copy_((one + two).half().float())
                two.zero_()
    half = {name: value.detach().numpy().astype(np.float16) for name, value in model.named_parameters()}
    out = {"dense": half["dense.weight"], "dense_bias": half["dense.bias"]}
    for k in range(6 if kind == "lstm" else 5):
        if kind == "lstm":
            out[f"weight_ih_{k}"] = half[f"lstm.weight_ih_l{k}"]
            out[f"weight_hh_{k}"] = half[f"lstm.weight_hh_l{k}"]
            out[f"bias_{k}"] = half[f"lstm.bias_ih_l{k}"]
        else:
            out[f"kernel_{k}"] = np.ascontiguousarray(half[f"convs.{k}.weight"].transpose(2, 1, 0))
            out[f"bias_{k}"] = half[f"convs.{k}.bias"]
    return out


def made_up(count: int) -> np.ndarray:
    """Readings (n, 6) of no foot: swings, rests and noise, to hold another implementation to this one."""
    rng = np.random.default_rng(7)
    swing = np.clip(np.sin(2.0 * np.pi * np.arange(count) / 110.0), 0.0, None)[:, None]
    acc = np.array([0.5, -1.0, 9.7]) + swing * rng.normal(0.0, 6.0, (count, 3)) + rng.normal(0.0, 0.05, (count, 3))
    gyr = swing * np.array([0.3, 4.0, -0.5]) + rng.normal(0.0, 0.02, (count, 3))
    return np.hstack([acc, gyr]).astype(np.float32)


def main() -> None:
    """Train, judge and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kind", choices=("lstm", "tcn"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--steps", type=int, default=3000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()

    import torch

    model, seen, held = train(given.kind, given.folder, given.steps, given.seed)
    arrays = arrays_of(given.kind, model)
    test = read_trials(given.folder, TEST_SESSIONS)
    record = {
        "kind": given.kind,
        "threshold": 0.5,  # with the 0.85 of P4 stances of running are lost: 0.26 m instead of 0.12 m on these trials
        "rate_hz": 200,
        "data": "University of Toronto foot-mounted inertial navigation data set, VICON trials (Wagstaff et al. 2019)",
        "labels": "thresholds of SHOE or angular-rate energy with the least position error of each trial",
        "trained_on": [t.name for t in seen],
        "chosen_on": [t.name for t in held],
        "never_seen": [t.name for t in test],
        "seed": given.seed,
        "steps": given.steps,
        "torch": torch.__version__.split("+")[0],
        "parameters": int(sum(a.size for a in arrays.values())),
        "on_training_trials": accuracy(given.kind, model, seen),
        "on_chosen_trials": accuracy(given.kind, model, held),
        "on_unseen_trials": accuracy(given.kind, model, test),
    }
    sample = made_up(300)  # nothing of the data set goes into the repository but what the weights remember
    with torch.no_grad():
        answer = torch.softmax(model(torch.from_numpy(inputs_of(given.kind, sample))[None])[0], dim=1)[:, 1].numpy()
    scale = np.array(INPUT_SCALE[given.kind], dtype=np.float32)
    given.out.parent.mkdir(parents=True, exist_ok=True)
    np.savez_compressed(given.out, **arrays, input_scale=scale, record=json.dumps(record))
    np.savez_compressed(given.out.with_suffix(".reference.npz"), imu=sample, standing=answer)
    print(json.dumps(record, indent=1))


if __name__ == "__main__":
    main()
