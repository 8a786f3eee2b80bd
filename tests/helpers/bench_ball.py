"""A ball on a bench, made here: what its microphone and its IMU give while it lies still and is knocked at."""

import numpy as np

from processing.live.check_items import GRAVITY_MPS2
from processing.live.stream import MotionBlock, SoundBlock
from processing.survey import ImuSamples

RATE, IMU_RATE = 16000, 200.0
IRREGULAR = (15.0, 15.9, 16.4, 17.6, 18.2)
HOST_S = 5000.0


class Bench:
    """A ball on a bench: what its sensors give from 0 to 30 s, with knocks at the given moments."""

    def __init__(self, knocks=IRREGULAR, seed=1, bias_dps=0.6, late_s=0.03, gravity=GRAVITY_MPS2, hiss=1e-3):
        rng = np.random.default_rng(seed)
        self.late_s = late_s
        time = np.arange(int(30 * RATE)) / RATE
        self.wave = hiss * rng.standard_normal(len(time))
        self.imu_s = np.arange(int(30 * IMU_RATE)) / IMU_RATE
        self.acc = np.array([0.0, 0.0, gravity]) + 0.02 * rng.standard_normal((len(self.imu_s), 3))
        self.gyr = np.radians([bias_dps, 0, 0]) + np.radians(0.05) * rng.standard_normal((len(self.imu_s), 3))
        for at in knocks:
            after = np.maximum(time - at, 0.0)
            self.wave += 0.3 * np.exp(-after / 0.01) * np.sin(2 * np.pi * 3000 * after)
            self.acc[:, 0] += 30.0 * np.exp(-0.5 * ((self.imu_s - at) / 0.004) ** 2)
        self.knocks = knocks

    def sound(self, start_s, end_s):
        first, end = int(start_s * RATE), int(end_s * RATE)
        frames = np.round(self.wave[first:end, None] * 2.0**31).clip(-(2**31), 2**31 - 1).astype(np.int32)
        return SoundBlock(frames, first, HOST_S + first / RATE + self.late_s)

    def motion(self, start_s, end_s):
        rows = (self.imu_s >= start_s) & (self.imu_s < end_s)
        count = int(rows.sum())
        imu = ImuSamples(self.imu_s[rows], self.acc[rows], self.gyr[rows], np.ones(count, np.bool_))
        return MotionBlock(imu, HOST_S + float(self.imu_s[rows][-1]))
