"""How much of a processor hearing an IMU takes, and whether every sample arrives: over a terminal, TCP and UDP.

Another process sends numbered samples at a steady rate (or as fast as they are taken: ``--rate 0``); the real link and
the decoder that finds the protocol by itself hear them. Figures: the hearing process's processor time as a share of
one processor, samples lost, and how late a sample is when it has been decoded.

    python tests/benchmarks/imu_link_load.py --rate 1000 --seconds 10
"""

import argparse
import os
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "helpers"), str(HERE.parent.parent)]

from imu_streams import HEADER, PROTOCOLS, messages  # noqa: E402

WIRES = ("pty", "tcp", "udp")
TICK_S = 0.001
DEADLINE_S = 60.0


def send(wire, protocol, rate_hz, seconds):
    """Print where to listen, wait for a line, send; the first sample's time is this computer's at its sending."""
    if wire == "pty":
        import tty

        master, slave = os.openpty()
        tty.setraw(slave)
        print(f"serial:{os.ttyname(slave)}@921600", flush=True)
        write = lambda data: os.write(master, data)  # noqa: E731
    elif wire == "tcp":
        server = socket.create_server(("127.0.0.1", 0))
        server.settimeout(DEADLINE_S)
        print(f"tcp:127.0.0.1:{server.getsockname()[1]}", flush=True)
        connection, _ = server.accept()
        write = connection.sendall
    else:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            address = free.getsockname()
        print(f"udp:127.0.0.1:{address[1]}", flush=True)
        datagrams = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        write = lambda data: datagrams.sendto(data, address)  # noqa: E731
    sys.stdin.readline()
    count = round((rate_hz or 20_000) * seconds)
    first_s = time.monotonic() + 2.0
    sent = messages(protocol, count, rate_hz=rate_hz or 1000.0, first_s=first_s)
    if protocol == "csv":
        sent[0] = HEADER + sent[0]
    time.sleep(max(0.0, first_s - time.monotonic()))
    begun, at = (time.monotonic(), 0)
    while at < count:
        due = count if not rate_hz else min(count, int((time.monotonic() - begun) * rate_hz))
        due = min(due, at + max(16, int(rate_hz / 50)))
        for message in sent[at:due]:
            data = memoryview(message)
            while data:
                data = data[write(data) or len(data) :]
        at = due
        if rate_hz:
            time.sleep(TICK_S)
    print(f"sent {time.monotonic() - begun:.3f}", flush=True)
    sys.stdin.readline()


def hear(wire, protocol, rate_hz, seconds):
    """Return a line of figures."""
    from app.devices.imu_link import ImuLink
    from app.devices.imu_spec import parse_imu_spec
    from processing.live.decoders import decoder_named

    words = [sys.executable, __file__, "--send", wire, protocol, "--rate", str(rate_hz), "--seconds", str(seconds)]
    child = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    killer = threading.Timer(DEADLINE_S + seconds, child.kill)
    killer.start()
    decoder, came, late, opened = decoder_named("auto"), [], [], threading.Event()

    def take(data, _host_s):
        found = decoder.feed(data)
        came.append(found.time_us)
        if rate_hz and len(found):
            late.append(time.monotonic() - 1e-6 * float(found.time_us[-1]))

    try:
        link = ImuLink(parse_imu_spec(child.stdout.readline().strip()), take, lambda *_: None)
        link.start()
        while not link.opened:
            opened.wait(0.01)
        child.stdin.write("go\n")
        child.stdin.flush()
        opened.wait(1.8)
        cpu, wall = time.process_time(), time.monotonic()
        took_s = float(child.stdout.readline().split()[1])
        count = round((rate_hz or 20_000) * seconds)
        until = time.monotonic() + 5.0
        while sum(map(len, came)) < count and time.monotonic() < until:
            opened.wait(0.01)
        cpu, wall = time.process_time() - cpu, time.monotonic() - wall
        link.stop()
    finally:
        child.kill()
        killer.cancel()
    got = len(np.unique(np.concatenate(came)))
    late_ms = 1e3 * np.percentile(late, [50, 99]) if late else (np.nan, np.nan)
    counts = decoder.counts()
    return (
        f"{wire:4} {protocol:11} sent {count:7d} lost {count - got:4d} garbage {counts.garbage_bytes:4d}  "
        f"{count / took_s:8.0f} a second  {100 * cpu / wall:5.2f} % of a processor  "
        f"late {late_ms[0]:5.1f} ms (99 %: {late_ms[1]:5.1f})"
    )


def main():
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("--send", nargs=2)
    words.add_argument("--rate", type=float, default=1000.0)
    words.add_argument("--seconds", type=float, default=10.0)
    words.add_argument("--wires", nargs="*", default=WIRES)
    words = words.parse_args()
    if words.send:
        send(*words.send, words.rate, words.seconds)
        return
    for wire in words.wires:
        for protocol in PROTOCOLS:
            print(hear(wire, protocol, words.rate, words.seconds), flush=True)


if __name__ == "__main__":
    main()
