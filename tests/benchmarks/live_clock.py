"""How well the clocks of a live recording are known after hours, by drift, bus and rate, and what that costs.

    python tests/benchmarks/live_clock.py [--hours 0.1 1 4] [--seeds 3]

Simulated arrivals with known truth. A line of the first table: the fit's largest error about the true line and in its
own sigmas, the drift's error and sigma. Of the second: samples placed one by one; for devices without times the step
from sample to sample against that of the arrivals. Of the third: the map from sound to survey time at both ends.
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "helpers"))

from arrivals import Sent, frames_at, told_by

from processing.live.arrival_fit import ArrivalFit
from processing.live.device_timeline import DeviceTimeline
from processing.live.sound_timeline import SoundTimeline, sound_to_survey

BUSES = {
    "usb 1 ms": (0.001, 0.0003, 0.0),
    "usb 16 ms": (0.016, 0.001, 0.0),
    "tcp": (0.020, 0.005, 0.0),
    "wi-fi": (0.020, 0.020, 0.02),  # a fiftieth of the messages 0.5 s late on the mean
}
WANDER_S = 3600.0  # period of a clock that follows its temperature, 0.5 ppm up and down


def stream(hours, rate_hz, ppm, bus, seed, wander_ppm=0.0):
    """Samples as a device on this bus sends them, with a stall of 2 s each quarter of an hour."""
    bundle_s, jitter_s, late_share = BUSES[bus]
    rng = np.random.default_rng(seed)
    true_s = np.arange(0, 3600 * hours, 1 / rate_hz)
    wander_s = 1e-6 * wander_ppm * WANDER_S / (2 * np.pi) * np.sin(2 * np.pi * true_s / WANDER_S)
    phase = rng.uniform(0, bundle_s)
    chunks_s, chunk = np.unique(np.ceil((true_s + phase) / bundle_s) * bundle_s - phase, return_inverse=True)
    late_s = rng.exponential(jitter_s, len(chunks_s))
    late_s += (rng.random(len(chunks_s)) < late_share) * rng.exponential(0.5, len(chunks_s))
    stalled_s = chunks_s % 900.0
    late_s = np.where(stalled_s < 2.0, np.maximum(late_s, 2.0 - stalled_s), late_s)
    host_s = np.maximum.accumulate(chunks_s + late_s)[chunk]
    return Sent(true_s + 1000.0, true_s * (1 + 1e-6 * ppm) + wander_s, host_s + 1000.0)


def fits(hours, seeds):
    print(
        "\nhours bus        rate   ppm wander | error ms (sigmas)  | drift error sigma ppm | jitter ms windows us/chunk"
    )
    for bus in BUSES:
        for rate_hz, ppm, wander_ppm in ((10, 80, 0), (100, -80, 0), (400, 80, 0), (100, 20, 0.5)):
            worst, sigmas, drifts, ppm_sigma, spent, chunks = 0.0, 0.0, [], 0.0, 0.0, 0
            fit = ArrivalFit()
            for seed in range(seeds):
                sent = stream(hours, rate_hz, ppm, bus, seed, wander_ppm)
                fit = ArrivalFit()
                edges = np.flatnonzero(np.diff(sent.host_s, prepend=-1.0))
                began = time.perf_counter()
                for start, end in zip(edges, [*edges[1:], len(sent.host_s)], strict=True):
                    fit.add(sent.device_s[start:end], sent.host_s[start:end])
                fit.host_of(0.0)
                spent += time.perf_counter() - began
                chunks += len(edges)
                at = np.linspace(0, len(sent.device_s) - 1, 500).astype(int)
                error_s = np.abs(fit.host_of(sent.device_s[at]) - sent.true_s[at])
                worst = max(worst, float(error_s.max()))
                sigma_s = np.hypot(fit.sigma_s_at(sent.device_s[at]), 1 / rate_hz / np.sqrt(12))  # as survey_s tells it
                sigmas = max(sigmas, float((error_s / sigma_s).max()))
                drifts.append(fit.drift_ppm - ppm)
                ppm_sigma = fit.drift_sigma_ppm
            print(
                f"{hours:5.1f} {bus:10s} {rate_hz:4d} {ppm:5d} {wander_ppm:6.1f} |{1e3 * worst:9.3f} ({sigmas:5.2f})  "
                f" | {max(np.abs(drifts)):11.4f} {ppm_sigma:10.4f} | {1e3 * fit.jitter_s:9.2f} {fit._count:8d} "
                f"{1e6 * spent / chunks:9.0f}"
            )


def placings(hours):
    print("\nhours bus        rate time |  lost  held back  axis error ms   step rms %  (arrivals %) | us/chunk")
    for bus in BUSES:
        for rate_hz in (10, 100, 1000):
            for has_time in (True, False):
                sent = stream(hours, rate_hz, 0.0, bus, 1)
                frames = frames_at(np.round(1e6 * sent.device_s) * has_time)
                timeline = DeviceTimeline()
                began = time.perf_counter()
                told = told_by(timeline, frames, sent.host_s, has_time)
                spent = time.perf_counter() - began
                placed = len(told.axis_s)
                settled = slice(min(30 * rate_hz, placed // 2), placed)
                off_s = (told.axis_s - (sent.true_s[:placed] - sent.true_s[0]))[settled]
                steps = np.diff(told.axis_s[settled]) * rate_hz - 1
                arrived = np.diff(sent.host_s[:placed][settled]) * rate_hz - 1
                chunks = np.count_nonzero(np.diff(sent.host_s)) + 1
                print(
                    f"{hours:5.1f} {bus:10s} {rate_hz:4d} {'yes' if has_time else 'no':>4s} | {told.total('lost'):5d} "
                    f"{len(frames) - placed:10d} {1e3 * np.ptp(off_s):14.3f} {100 * np.sqrt(np.mean(steps**2)):12.4f} "
                    f"{100 * np.sqrt(np.mean(arrived**2)):12.1f}   | {1e6 * spent / chunks:8.0f}"
                )


def maps(hours, seeds):
    print("\nhours adc ms  lost s | false alarms  found s (axis off ms) | start off ms (sigma)  end off ms  us/block")
    rate_hz, block = 48_000, 2048
    for jitter_s, losses in ((0.0001, ()), (0.010, ()), (0.001, (0.05, 1.0)), (0.010, (0.05, 1.0))):
        for seed in range(seeds):
            rng = np.random.default_rng(seed)
            sound, device = SoundTimeline(rate_hz), DeviceTimeline()
            sent = stream(hours, 50, -60.0, "usb 16 ms", seed)
            told_by(device, frames_at(np.round(1e6 * sent.device_s)), sent.host_s)
            count = round(3600 * hours * rate_hz / block)
            at = {round(count * (nth + 1) / (len(losses) + 1)): round(s * rate_hz) for nth, s in enumerate(losses)}
            missing, alarms, found = 0, 0, 0
            began = time.perf_counter()
            for nth in range(count):
                missing += at.get(nth, 0)
                true_s = 1000.0 + (nth * block + missing) / (rate_hz * (1 + 40e-6))
                lost = sound.place(block, true_s + rng.uniform(-jitter_s, jitter_s))
                found += lost
                alarms += lost > 0 and not any(0 <= nth - place < rate_hz / block for place in at)
            spent = time.perf_counter() - began
            guess = sound_to_survey(sound, device)
            end_s = sound.audio_s
            true_end_s = (end_s / (1 + 40e-6)) * (1 - 60e-6)  # seconds of the device when the card counts so many
            end_error_s = guess.start_time_s + end_s / (1 + 1e-6 * guess.drift_ppm) - true_end_s
            print(
                f"{hours:5.1f} {1e3 * jitter_s:6.1f} {sum(losses):7.2f} | {alarms:12d} {found / rate_hz:8.3f} "
                f"({1e3 * (found - missing) / rate_hz:8.3f})          | {1e3 * guess.start_time_s:9.2f} "
                f"({1e3 * guess.start_sigma_s:5.2f}) {1e3 * end_error_s:19.2f} {1e6 * spent / count:9.0f}"
            )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--hours", type=float, nargs="+", default=[0.1, 1.0])
    parser.add_argument("--seeds", type=int, default=3)
    given = parser.parse_args()
    for hours in given.hours:
        fits(hours, given.seeds)
    placings(given.hours[0])
    for hours in given.hours:
        maps(hours, given.seeds)


if __name__ == "__main__":
    main()
