"""Writes samples as each kind of device does, message by message, from the protocols' own words; for tests."""

import binascii
import struct
from functools import cache

import numpy as np

G = 9.80665
PROTOCOLS = ("frames", "csv", "printed", "ximu3", "ximu3_text")
HEADER = b"time_s,acc_x_mps2,acc_y_mps2,acc_z_mps2,gyr_x_radps,gyr_y_radps,gyr_z_radps\r\n"


def samples(count, seed=0, rate_hz=400.0, first_s=5.0):
    """Times (n,) in whole microseconds, force and turn rate (n, 3) in the protocol's decimals."""
    rng = np.random.default_rng(seed)
    time_us = np.rint(1e6 * (first_s + np.arange(count) / rate_hz)).astype(np.int64)
    acc_g = np.round(rng.normal(0, 0.3, (count, 3)) + np.array([0, 0, 1]), 4)
    gyr_dps = np.round(rng.normal(0, 60, (count, 3)), 4)
    return time_us, acc_g, gyr_dps


def frame(number, time_us, acc_g, gyr_dps):
    body = struct.pack("<BBIQ6f", 1, 0, number, time_us, *(G * acc_g), *np.radians(gyr_dps))
    return b"\xc5\x4c" + body + struct.pack("<H", binascii.crc_hqx(body, 0xFFFF))


def csv_line(_number, time_us, acc_g, gyr_dps):
    return (
        ",".join([f"{1e-6 * time_us:.6f}", *(f"{v:.9g}" for v in (*(G * acc_g), *np.radians(gyr_dps)))]).encode()
        + b"\r\n"
    )


def printed_line(_number, time_us, acc_g, gyr_dps):
    acc, gyr = (",".join(f"{v:.4f}" for v in values) for values in (acc_g, gyr_dps))
    return (
        f"{time_us} us: Accelerometer(xyz)={acc}, Gyroscope(xyz)={gyr}, Magnetometer(xyz)=12.5,-3.0,40.25---\r\n"
    ).encode()


def ximu3(kind, time_us, *values):
    body = bytes([0x80 + ord(kind)]) + struct.pack(f"<Q{len(values)}f", time_us, *values)
    return body.replace(b"\xdb", b"\xdb\xdd").replace(b"\n", b"\xdb\xdc") + b"\n"


def ximu3_text(kind, time_us, *values):
    return f"{kind},{time_us},{','.join(f'{v:.4f}' for v in values)}\r\n".encode()


def messages(protocol, count, **options):
    """One message a sample."""
    return list(_messages(protocol, count, **options))


@cache
def _messages(protocol, count, **options):
    write = {
        "frames": frame,
        "csv": csv_line,
        "printed": printed_line,
        "ximu3": lambda _n, t, a, w: ximu3("I", t, *w, *a),
        "ximu3_text": lambda _n, t, a, w: ximu3_text("I", t, *w, *a),
    }[protocol]
    rows = zip(*samples(count, **options), strict=True)
    return tuple(write(number, int(time_us), acc, gyr) for number, (time_us, acc, gyr) in enumerate(rows))
