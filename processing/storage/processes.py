"""Is a process of this computer still alive, and is it still the same one? Linux, Windows and macOS.

A process id alone is not enough: after a restart the system gives it to somebody else. The start time settles it.
"""

import ctypes
import os
import subprocess
import sys
from pathlib import Path


def process_start(pid: int) -> str | None:
    """Return a text that names this life of process ``pid``, None if there is no such process."""
    if pid <= 0:
        return None
    if sys.platform == "win32":
        return _start_on_windows(pid)
    else:  # noqa: RET505  # the type checker reads one branch for each system
        return _start_on_linux(pid) if Path("/proc/self/stat").exists() else _start_by_ps(pid)


def own_start() -> str:
    """Return :func:`process_start` of this process."""
    return process_start(os.getpid()) or "unknown"


def _start_on_linux(pid: int) -> str | None:
    try:
        stat = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace")
        boot = Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
    except OSError:
        return None
    fields = stat.rpartition(")")[2].split()  # the command's name may hold spaces and brackets
    state, start_ticks = fields[0], fields[19]
    return None if state in ("Z", "X") else f"{boot}:{start_ticks}"


def _start_by_ps(pid: int) -> str | None:
    done = subprocess.run(["ps", "-o", "lstart=", "-p", str(pid)], capture_output=True, text=True, check=False)
    return done.stdout.strip() or None


def _start_on_windows(pid: int) -> str | None:
    kernel32 = ctypes.WinDLL("kernel32", use_last_error=True)  # type: ignore[attr-defined,unused-ignore]
    kernel32.OpenProcess.restype = ctypes.c_void_p
    query_limited_information, still_active = 0x1000, 259
    handle = kernel32.OpenProcess(query_limited_information, False, pid)
    if not handle:
        access_denied = 5  # it lives, but belongs to another user: alive, start unknown
        return "unknown" if ctypes.get_last_error() == access_denied else None  # type: ignore[attr-defined,unused-ignore]
    try:
        exit_code, times = ctypes.c_ulong(), [ctypes.c_ulonglong() for _ in range(4)]
        kernel32.GetExitCodeProcess(ctypes.c_void_p(handle), ctypes.byref(exit_code))
        if exit_code.value != still_active:
            return None
        kernel32.GetProcessTimes(ctypes.c_void_p(handle), *(ctypes.byref(t) for t in times))
        return str(times[0].value)
    finally:
        kernel32.CloseHandle(ctypes.c_void_p(handle))
