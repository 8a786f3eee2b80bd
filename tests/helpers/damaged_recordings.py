"""Small folders shaped like those of every logger, as bytes, and a mutator that damages them as cards and cables do."""

import io

import numpy as np
import soundfile

DEG = np.pi / 180
G = 9.80665


def _motion(count=300):
    rng = np.random.default_rng(5)
    time = np.arange(count) / 100
    angle = 2.0 * np.sin(1.5 * time)
    gyr = np.column_stack([3.0 * np.cos(1.5 * time), 0 * time, 0 * time]) + rng.normal(0, 0.003, (count, 3))
    acc = G * np.column_stack([0 * time, np.sin(angle), np.cos(angle)]) + rng.normal(0, 0.03, (count, 3))
    return time, acc, gyr, rng.normal(20, 5, (count, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))


def _csv(columns, separator=",", above="", end="\n"):
    cells = [[f"{v:.6f}" if isinstance(v, float) else str(v) for v in np.asarray(c).tolist()] for c in columns.values()]
    lines = [separator.join(columns), *(separator.join(row) for row in zip(*cells, strict=True))]
    return (above + end.join(lines) + end).encode()


def _xyz(pattern, values, letters="xyz"):
    return {pattern.format(letter): values[:, "xyz".index(letter.lower())] for letter in letters}


def _wav(count=4000, **kwargs):
    stream = io.BytesIO()
    samples = np.random.default_rng(1).normal(0, 0.1, count)
    soundfile.write(stream, samples, 8000, **({"format": "WAV", "subtype": "PCM_16"} | kwargs))
    return stream.getvalue()


SURVEY = b"""[survey]
name = "Station Road"
date = 2026-05-04
[pipe]
length_m = 12.5
[audio]
file = "audio.wav"
start_time_s = 0.5
[[tie_points]]
name = "end"
time_s = 2.0
chainage_m = 12.0
[route]
points = [[0.0, 0.0, 0.0], [12.0, 4.0, -0.5]]
"""


def seeds():
    """Return name → files (name → bytes) of one sound recording of every kind."""
    time, acc, gyr, mag, quat = _motion()
    us, ns = np.round(time * 1e6).astype(int), np.round(time * 1e9).astype(np.int64) + 1767620467350470700
    neutral = {"time_s": time} | _xyz("acc_{}_mps2", acc) | _xyz("gyr_{}_radps", gyr) | _xyz("mag_{}_uT", mag)
    neutral |= {f"quat_{letter}": quat[:, i] for i, letter in enumerate("wxyz")}
    xsens = {"PacketCounter": np.arange(300), "SampleTimeFine": us + 4294000000}
    xsens |= _xyz("Acc_{}", acc, "XYZ") | _xyz("Gyr_{}", gyr, "XYZ") | _xyz("Mag_{}", mag / 50, "XYZ")
    xio = {"Timestamp (us)": us} | _xyz("Gyroscope {} (deg/s)", gyr / DEG, "XYZ")
    xio |= _xyz("Accelerometer {} (g)", acc / G, "XYZ")
    stamps = {"time": ns, "seconds_elapsed": time}
    clock = [f"23:59:{57 + i // 100:02d}.{i % 100:02d}0" for i in range(300)]
    printed = "".join(
        f"Accelerometer(xyz)={a[0]:.4f},{a[1]:.4f},{a[2]:.4f}, Gyroscope(xyz)={w[0]:.4f},{w[1]:.4f},{w[2]:.4f}, "
        f"Magnetometer(xyz)={m[0]:.4f},{m[1]:.4f},{m[2]:.4f}---\r\n"
        for a, w, m in zip(acc / G, gyr / DEG, mag, strict=True)
    )
    plain = {"t": time} | _xyz("a{}", acc) | _xyz("g{}", gyr)
    return {
        "neutral": {"imu.csv": _csv(neutral), "audio.wav": _wav(), "survey.toml": SURVEY},
        "printed": {"run.log": printed.encode()},
        "x-imu3": {
            "Inertial.csv": _csv(xio),
            "Magnetometer.csv": _csv({"Timestamp (us)": us[::4]} | _xyz("Magnetometer {} (a.u.)", mag[::4], "XYZ")),
            "Quaternion.csv": _csv({"Timestamp (us)": us} | {n: quat[:, i] for i, n in enumerate("WXYZ")}),
        },
        "mt manager": {"MT_0.txt": _csv(xsens, "\t", "// Start Time: Unknown\n// Update Rate: 100.0Hz\n")},
        "dot": {"dot.csv": _csv(xsens, ",", "sep=,\nDeviceTag:,1\nOutputRate:,100Hz\n\n")},
        "phyphox": {
            "Accelerometer.csv": _csv({'"Time (s)"': time + 0.003} | _xyz('"{} (m/s^2)"', acc, "XYZ")),
            "Gyroscope.csv": _csv({'"Time (s)"': time} | _xyz('"{} (rad/s)"', gyr, "XYZ")),
        },
        "sensor logger": {
            "Accelerometer.csv": _csv(stamps | _xyz("{}", acc * 0.3, "zyx")),
            "Gravity.csv": _csv(stamps | _xyz("{}", acc * 0.7, "zyx")),
            "Gyroscope.csv": _csv(stamps | _xyz("{}", gyr, "zyx")),
        },
        "semicolons": {"log.csv": _csv(plain, ";").replace(b".", b",")},
        "clock": {"log.txt": _csv({"clock": clock} | _xyz("acc_{}", acc) | _xyz("gyr_{}", gyr), "\t", "# made\n")},
        "utf-16": {"log.csv": _csv(plain).decode().encode("utf-16")},
        "no names": {"log.dat": _csv(plain, " ").split(b"\n", 1)[1]},
        "flac": {"imu.csv": _csv(plain), "audio.flac": _wav(format="FLAC")},
        "w64": {"imu.csv": _csv(neutral), "a_1.w64": _wav(format="W64"), "a_2.w64": _wav(format="W64")},
    }


def _flip(data, rng):
    out = bytearray(data)
    for at in rng.integers(0, len(out), rng.integers(1, 30)):
        out[at] ^= 1 << rng.integers(0, 8)
    return bytes(out)


def _header_flip(data, rng):
    out = bytearray(data)
    for at in rng.integers(0, min(len(out), 120), rng.integers(1, 6)):
        out[at] = rng.integers(0, 256)
    return bytes(out)


def _cut(data, rng):
    return data[: rng.integers(0, len(data))]


def _drop(data, rng):
    a, b = sorted(rng.integers(0, len(data) + 1, 2))
    return data[:a] + data[b:]


def _repeat(data, rng):
    a, b = sorted(rng.integers(0, len(data) + 1, 2))
    return data[:b] + data[a:b] * int(rng.integers(1, 4)) + data[b:]


def _lines(data, rng):
    lines = data.split(b"\n")
    for _ in range(rng.integers(1, 20)):
        a, b = rng.integers(0, len(lines), 2)
        match rng.integers(0, 3):
            case 0:
                lines[a], lines[b] = lines[b], lines[a]
            case 1:
                lines.insert(a, lines[b])
            case _:
                lines[a] = b""
    return b"\n".join(lines)


def _swap_separator(data, rng):
    a, b = rng.choice([b",", b";", b"\t", b" ", b".", b"\n", b"\r\n", b"-", b":", b'"'], 2)
    return data.replace(bytes(a), bytes(b), int(rng.integers(1, 4000)))


def _strange_words(data, rng):
    words = [
        b"1e999", b"-1e308", b"9" * 400, b"nan", b"inf", b"-", b"", b"1e-320", b"0x10", b"1_000", b"\xff\xfe", b"1,5",
        b"'", b'"', b"\0" * 50, b"99999999999999999999", b"2147483648", b"Accelerometer(xyz)=", b"[[", b"=", b"#",
        b"\r", b"a" * 5000,
    ]  # fmt: skip
    out = data
    for _ in range(rng.integers(1, 8)):
        at = int(rng.integers(0, len(out) + 1))
        word = words[rng.integers(0, len(words))]
        out = out[:at] + word + out[at + int(rng.integers(0, 2)) * len(word) :]
    return out


def _one_cell(data, rng):
    """Replace a column's worth of cells by one value: dead channels, equal times, huge units."""
    lines = data.split(b"\n")
    separator = max((b",", b";", b"\t", b" "), key=data.count)
    column, value = int(rng.integers(0, 12)), rng.choice([b"0", b"1e300", b"nan", b"1", b"-7.5", b"1e-300", b"x"])
    for i in range(rng.integers(0, 5), len(lines), int(rng.integers(1, 4))):
        cells = lines[i].split(separator)
        if column < len(cells):
            cells[column] = bytes(value)
            lines[i] = separator.join(cells)
    return b"\n".join(lines)


def _zeros(data, rng):
    a, b = sorted(rng.integers(0, len(data) + 1, 2))
    return data[:a] + bytes(b - a) + data[b:]


def _binary(data, rng):
    return rng.bytes(int(rng.integers(0, 5000)))


def _one_line(data, rng):
    return data.replace(b"\n", b" ") * int(rng.integers(1, 40))


MUTATIONS = (
    _flip, _header_flip, _cut, _drop, _repeat, _lines, _swap_separator, _strange_words, _one_cell, _zeros, _binary,
    _one_line,
)  # fmt: skip


def mutated(number, kinds):
    """Return the ``number``-th damaged recording: its kind and its files; the same number gives the same damage."""
    rng = np.random.default_rng(number)
    name = list(kinds)[number % len(kinds)]
    files = dict(kinds[name])
    for _ in range(rng.integers(1, 4)):
        victim = list(files)[rng.integers(0, len(files))]
        if files[victim]:
            files[victim] = MUTATIONS[rng.integers(0, len(MUTATIONS))](files[victim], rng)[:4_000_000]
    return name, files
