"""What cleaning takes away: decibels of rolling lines, of swelling rolling noise, and of the leak; and its speed.

python tests/benchmarks/bench_cleaning.py [FOLDER_OF_LEAK_RECORDINGS] [TEXT_OF_A_CASE'S_NAME ...]

A drive of two minutes is simulated with rolling lines, rolling noise, bumps at the joints and no leak; a leak
(Gaussian noise of a leak's spectrum, or a real recording, repeated) is added at a steady level. The gains are those
that the cleaner chose for the mixture, and are then applied to each ingredient alone, as is usual for noise
suppressors: what comes out of the lines is what is left of them, what comes out of the leak is what is left of it.
Beside it, independent of the cleaner: how far the power at the true orders stands above that between them, before and
after.
"""

import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import soundfile
from scipy import signal

from processing.settings import CleaningSettings, DetectorSettings, SoundSettings
from processing.simulation.lines import line_sound
from processing.simulation.run import simulate
from processing.simulation.scenario import Ball, Drive, Imu, Joints, PipeRoute, RollingLine, Scenario, Sound
from processing.simulation.sound import sound_blocks
from processing.sound.cells import frames_of
from processing.sound.cleaning import CleanReader, NotCleaned, learn_cleaning
from processing.sound.cleaning_bands import BandCleaner
from processing.sound.orders import OrderParts, OrderWindows
from processing.sound.orders_lines import LineRemover
from processing.sound.scan import scan
from processing.sound.source import open_audio
from processing.survey import Track

ORDERS = (1, 2, 4, 7, 12, 18, 24, 36, 54, 72, 96, 144, 200, 288, 400)
DENSE = tuple(range(20, 420))
EDGE_S = 22.0  # rests and ramps
BAND_HZ = (500.0, 4000.0)


class Memory:
    def __init__(self, sound):
        self.sound = sound

    def read(self, start, count):
        return self.sound[start : start + count]


class Shadow:
    """The cleaner of a mixture, whose gains are applied to another sound."""

    def __init__(self, mixture, context, rate_hz):
        self.context, self.rate_hz, self.frames = context, rate_hz, len(mixture)
        self._windows = self._windows_of(mixture)
        self._remover = LineRemover(self._windows, context.lines)
        self._gains, self._chosen = {}, {}
        for window in range(self._windows.count):
            spectrum = self._windows.spectrum(window)
            if spectrum is not None:
                self._gains[spectrum.start_rad] = self._remover.gains(spectrum)
        self._bands = self._bands_of(mixture - self.lines(mixture))

    def _windows_of(self, sound):
        settings = self.context.settings
        return OrderWindows(Memory(sound), len(sound), self.rate_hz, self.context.turning, settings.lines_to_hz)

    def _bands_of(self, sound):
        context = self.context
        return BandCleaner(Memory(sound), context.grid, context.bands_hz, context.gains, context.settings)

    def lines(self, sound):
        """Return what the line remover takes out of ``sound`` with the mixture's gains."""

        def choose(spectrum):
            gains = self._gains[spectrum.start_rad]
            out = np.zeros_like(spectrum.bins)
            out[: len(gains)] = spectrum.bins[: len(gains)] * gains
            return out

        return OrderParts(self._windows_of(sound), choose).read(0, len(sound))

    def bands(self, sound):
        """Return ``sound`` after the gains of the bands."""
        cleaner = self._bands_of(sound)
        own = cleaner._measured

        def measured(number):
            if number not in self._chosen:
                self._chosen[number] = self._bands._measured(number)[1:]
            return (own(number)[0], *self._chosen[number])

        cleaner._measured = measured
        return cleaner.read(0, len(sound))


def drive(orders, level_dbfs, gyro_scale, variation, seed, seconds=120.0, speed=0.6, **more):
    """Return a simulated run with lines of ``level_dbfs`` each."""
    lines = tuple(RollingLine(float(order), level_dbfs) for order in orders)
    return simulate(
        Scenario(
            "cleaning",
            route=PipeRoute(((0.0, 0.0, 0.0), (seconds * speed, 0.0, 0.0))),
            drive=Drive(speed_mps=speed, variation=variation),
            ball=Ball(radius_m=0.08),
            imu=replace(Imu(), gyro_scale_sigma=0.0, gyro_scale_range=(abs(gyro_scale - 1),) * 2),
            sound=Sound(rolling_lines=lines, joints=Joints(5.5, 0.25), bends_rumble=False, **more),
        ),
        seed,
    )


def parts_of(run):
    """Return the sound without lines, and the lines."""
    plan = run.sound
    bare = np.concatenate(list(sound_blocks(replace(plan, lines=type(plan.lines)()))))
    lines = [
        line_sound(plan.lines, plan.heard_at(np.arange(a, min(a + 65536, plan.frames)) / plan.rate_hz), plan.rate_hz)
        for a in range(0, plan.frames, 65536)
    ]
    return bare, np.concatenate(lines)


def leak_of(kind, count, rate, rng):
    """Return ``count`` samples of a leak with unit power in the band."""
    if kind is None:
        sos = signal.butter(2, [700, 2400], "bandpass", fs=rate, output="sos")
        sound = signal.sosfilt(sos, rng.standard_normal(count))
    else:
        data, own_rate = soundfile.read(kind, always_2d=True)
        sound = signal.resample_poly(data[:, 0], rate, own_rate) if own_rate != rate else data[:, 0]
        sound = np.tile(sound, -(-count // len(sound)))[:count]
        # what these recordings hold below the leak band is their tank and mains, and would hide any line
        sound = signal.sosfilt(signal.butter(6, 500, "highpass", fs=rate, output="sos"), sound)
    return (sound / np.sqrt(band_power(sound, rate))).astype(np.float32)


def band_power(sound, rate, band_hz=BAND_HZ):
    hz, power = signal.welch(sound, rate, nperseg=8192)
    inside = (hz >= band_hz[0]) & (hz <= band_hz[1])
    return float(power[inside].sum() * (hz[1] - hz[0]))


def at_orders(sound, angle, orders, turns=16):
    """Return the mean decibels by which the true orders stand over what lies between, by the FFT over even angles."""
    steps = 1 << 20
    hits, beside = [], []
    bins = np.round(turns * np.array(orders)).astype(int)
    for start in np.arange(angle[0], angle[-1] - 2 * np.pi * turns, 2 * np.pi * turns):
        even = np.interp(start + 2 * np.pi * turns * np.arange(steps) / steps, angle, sound)
        power = np.square(np.abs(np.fft.rfft(even * np.hanning(steps))))
        hits.append(power[bins])
        beside.append(power[bins + turns // 2])
    return float(np.mean(10 * np.log10(np.mean(hits, axis=0) / np.mean(beside, axis=0)))) if len(bins) else 0.0


def context_of(mixture, run, folder, settings):
    rate, path = run.sound.rate_hz, folder / "mixture.wav"
    soundfile.write(path, mixture, rate, subtype="FLOAT")
    source, _ = open_audio([path])
    scanned = scan(source, SoundSettings(), out_dir=folder / "scan", threads=1)
    motion = run.motion
    every = slice(None, None, 10)
    place = motion.chainage_m[every]
    flat = np.zeros(len(place))
    track = Track(
        motion.time_s[every], place, np.column_stack([place, flat, flat]), flat + 0.1, flat + 0.1, flat + 0.1,
        np.tile([1.0, 0, 0, 0], (len(flat), 1)), motion.speed_mps[every], "truth",
    )  # fmt: skip
    frames = frames_of(scanned, run.clock, track, (), DetectorSettings())
    began = time.process_time()
    context = learn_cleaning(source, run.imu, scanned, frames, run.clock, settings)
    return source, context, time.process_time() - began


def measure(name, run, leak, snr_db, settings=CleaningSettings()):  # noqa: B008  # frozen
    rate = run.sound.rate_hz
    bare, lines = parts_of(run)
    leak = leak * np.float32(np.sqrt(band_power(bare + lines, rate) * 10 ** (snr_db / 10)))
    mixture = bare + lines + leak
    with tempfile.TemporaryDirectory() as text:
        source, context, learnt_s = context_of(mixture, run, Path(text), settings)
        if isinstance(context, NotCleaned):
            print(f"{name:42s} {context}")
            return
        shadow = Shadow(mixture, context, rate)
        began = time.process_time()
        with CleanReader(source, context) as reader:
            cleaned = np.concatenate([reader.read(a, 4096) for a in range(0, source.frames, 4096)])
        cleaned_s = time.process_time() - began
        began = time.process_time()
        with CleanReader(source, context) as reader:
            reader.read(source.frames // 2, 2048)
        first_ms = 1000 * (time.process_time() - began)
    own = slice(int(EDGE_S * rate), -int(EDGE_S * rate))

    def lost(before, after, band_hz=None):
        if band_hz is None:
            return 10 * np.log10(np.mean(np.square(before[own])) / np.mean(np.square(after[own])))
        return 10 * np.log10(band_power(before[own], rate, band_hz) / band_power(after[own], rate, band_hz))

    left = {part: sound - shadow.lines(sound) for part, sound in (("lines", lines), ("leak", leak), ("bare", bare))}
    whole = {part: shadow.bands(sound) for part, sound in left.items()}
    apart = np.std(sum(whole.values())[own] - cleaned[own]) / np.std(cleaned[own])
    assert apart < 0.02, apart  # the shadow is the cleaner, but for the clipped bumps
    angle = np.interp(run.clock.to_survey(np.arange(len(mixture)) / rate), run.motion.time_s, run.motion.rotation_rad)[
        own
    ]
    orders = [x.order for x in run.scenario.sound.rolling_lines if x.order * 1.3 < 2200][:: max(1, len(ORDERS) // 8)]
    before, after = (at_orders(x[own], angle, orders[:12]) for x in (mixture, cleaned))
    rolling = lost(left["bare"], whole["bare"], (400, 2400)) - lost(left["leak"], whole["leak"], (400, 2400))
    print(
        f"{name:42s} lines -{lost(lines, left['lines']):4.1f} dB   at the orders {before:5.1f} -> {after:5.1f} dB"
        f"   leak lost {lost(leak, left['leak'], BAND_HZ):5.2f} + {lost(left['leak'], whole['leak'], BAND_HZ):5.2f} dB"
        f"   rest of rolling -{rolling:4.1f} dB   {len(context.lines.orders):3d} lines, scale {context.lines.scale}"
        f"   {len(mixture) / rate / cleaned_s:4.0f} x real time a core, first block {first_ms:.0f} ms,"
        f" learnt in {learnt_s:.1f} s",
        flush=True,
    )


def cases(folder):
    """Yield name, lines' orders and dBFS each, gyro scale, variation of the speed, seed, leak's SNR, file, and more."""
    for level, snr in ((-52.0, 0.0), (-62.0, -10.0), (-62.0, 0.0), (-62.0, 10.0), (-72.0, 0.0)):
        yield f"lines {level:g} dBFS each, leak {snr:+g} dB", ORDERS, level, 1.0, 0.1, 1, snr, None, {}
    yield "gyro's scale 2 % off", ORDERS, -62.0, 1.02, 0.1, 1, 0.0, None, {}
    yield "gyro's scale 2 % off, other seed", ORDERS, -62.0, 1.02, 0.1, 2, 0.0, None, {}
    yield "speed varies by 30 %", ORDERS, -62.0, 1.0, 0.3, 3, 0.0, None, {}
    yield "400 orders in a row", DENSE, -68.0, 1.0, 0.1, 1, 0.0, None, {}
    yield "no lines", (), -62.0, 1.0, 0.1, 1, 0.0, None, {}
    wander = {"lines_wander_rad": 0.6, "lines_stable_m": 2.0}
    yield "lines that wander 0.6 rad in 2 m", ORDERS, -62.0, 1.0, 0.1, 1, 0.0, None, wander
    for recording in sorted(folder.glob("*.wav")) if folder is not None else ():
        yield f"{recording.stem}, 0 dB", ORDERS, -62.0, 1.0, 0.1, 1, 0.0, recording, {}


def main():
    arguments = sys.argv[1:]
    folder = next((Path(a) for a in arguments if Path(a).is_dir()), None)
    wanted = [a for a in arguments if not Path(a).is_dir()]
    rng = np.random.default_rng(0)
    for name, orders, level, scale, variation, seed, snr, file, more in cases(folder):
        if not wanted or any(text in name for text in wanted):
            run = drive(orders, level, scale, variation, seed, **more)
            measure(name, run, leak_of(file, run.sound.frames, run.sound.rate_hz, rng), snr)


if __name__ == "__main__":
    main()
