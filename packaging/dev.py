#!/usr/bin/env python3
"""Sets Leakline up on a fresh machine, then runs it or its checks; standard library only.

    python3 packaging/dev.py run [ARGUMENTS OF leakline]   opens the demonstration, or does what the arguments say
    python3 packaging/dev.py test [ARGUMENTS OF pytest]    lint, types, architecture, tests (on all processors)

What it makes stays in ``.venv``; a second run finds it there and starts at once.
"""

from __future__ import annotations

import contextlib
import ctypes
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
VENV = ROOT / ".venv"
STAMP = VENV / "leakline-setup.json"
PYTHON = VENV / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
LAST_FAILED = ".pytest_cache/v/cache/lastfailed"
SECOND_CHANCES = 8  # more than that is no accident
PARALLEL_S = 1800.0  # several times what they take
OLDEST, NEWEST = (3, 11), (3, 13)

# Debian package: what shows that it is there (a shared library, or a program)
LIBRARIES = {
    "libglib2.0-0": "libglib-2.0.so.0",
    "libgl1": "libGL.so.1",
    "libegl1": "libEGL.so.1",
    "libxkbcommon0": "libxkbcommon.so.0",
    "libfontconfig1": "libfontconfig.so.1",
    "libdbus-1-3": "libdbus-1.so.3",
    "libxkbcommon-x11-0": "libxkbcommon-x11.so.0",
    "libxcb-cursor0": "libxcb-cursor.so.0",
    "libxcb-icccm4": "libxcb-icccm.so.4",
    "libxcb-keysyms1": "libxcb-keysyms.so.1",
    "libxcb-shape0": "libxcb-shape.so.0",
    "libportaudio2": "libportaudio.so.2",
}
TEST_PROGRAMS = {
    "xvfb": "Xvfb",
    "xdotool": "xdotool",
    "poppler-utils": "pdftoppm",
    "pulseaudio": "pulseaudio",  # the sound card of the tests, on its own socket
    "pulseaudio-utils": "paplay",
}
ALSA_PLUGINS = {"libasound2-plugins": "libasound_module_pcm_pulse.so"}  # by which PortAudio reaches that server


def main(arguments: list[str]) -> int:
    """Set up what the command needs and run it; returns its exit status."""
    if not arguments or arguments[0] not in {"run", "test", "setup"}:
        print(__doc__, file=sys.stderr)
        return 2
    command, rest = arguments[0], arguments[1:]
    use_supported_python(arguments)
    set_up(for_tests=command == "test")
    if command == "run":
        return run(rest)
    if command == "test":
        return test(rest)
    return 0


def use_supported_python(arguments: list[str]) -> None:
    """Go on under a Python that the libraries support, or say which is needed."""
    if OLDEST <= sys.version_info[:2] <= NEWEST:
        return
    for minor in range(NEWEST[1], OLDEST[1] - 1, -1):
        other = shutil.which(f"python3.{minor}")
        if other:
            raise SystemExit(subprocess.call([other, __file__, *arguments]))
    raise SystemExit(
        f"Leakline needs Python 3.{OLDEST[1]} to 3.{NEWEST[1]}; this is {sys.version.split()[0]}. "
        "Install one of them (python.org, or your system's packages) and run this command with it."
    )


# --- the environment ----------------------------------------------------------------------------------------------


def set_up(for_tests: bool) -> None:
    """Make ``.venv`` with the locked packages, and build the compiled recursions, unless it is there already."""
    install_system_packages(for_tests)
    lock = ROOT / "packaging" / ("requirements-dev.txt" if for_tests else "requirements.txt")
    done = read_stamp()
    if not PYTHON.exists() or done.get("python") != sys.version:
        say("making the environment in .venv")
        make_venv()
        done = {"python": sys.version, "locks": []}
    if digest(lock) not in done["locks"]:
        say("installing packages (a few minutes the first time)")
        pip("install", "--require-hashes", "--requirement", str(lock))
        done["locks"].append(digest(lock))
    if done.get("project") != project_digest():
        say("building Leakline")
        pip("install", "--no-deps", "--no-build-isolation", "--editable", str(ROOT))
        done["project"] = project_digest()
        if not list((ROOT / "processing").glob("**/kernels*.so")) + list((ROOT / "processing").glob("**/*.pyd")):
            say("no C compiler was found: long recordings will take several times longer to process")
    STAMP.write_text(json.dumps(done), encoding="utf-8")


def make_venv() -> None:
    """Create ``.venv`` with pip; on a Debian without python3-venv, get that first or say so."""
    command = [sys.executable, "-m", "venv", "--clear", str(VENV)]
    if subprocess.call(command, stdout=subprocess.DEVNULL) == 0:
        return
    package = f"python3.{sys.version_info[1]}-venv"
    if may_install() and apt_install([package]) and subprocess.call(command) == 0:
        return
    raise SystemExit(f"The environment could not be made. On Debian and Ubuntu: sudo apt-get install {package}")


def pip(*arguments: str) -> None:
    """Run pip in the environment; its complaints are shown, and end the set-up."""
    quiet = ["--quiet", "--disable-pip-version-check", "--no-input"]
    if subprocess.call([str(PYTHON), "-m", "pip", *arguments, *quiet]) != 0:
        raise SystemExit(
            "The packages could not be installed (see above). They are fetched once, so a network is needed "
            "for the first run; then run the same command again."
        )


def read_stamp() -> dict:
    """Return what earlier set-ups did, or nothing where there is no (readable) note of it."""
    try:
        return json.loads(STAMP.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


def digest(path: Path) -> str:
    """Return the hash of a file's content."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def project_digest() -> str:
    """Return a hash of all that the built project depends on."""
    files = [ROOT / "pyproject.toml", ROOT / "setup.py", *sorted((ROOT / "processing").glob("**/kernels*.py"))]
    return hashlib.sha256("".join(str(f) + digest(f) for f in files).encode()).hexdigest()


# --- what Debian must give ------------------------------------------------------------------------------------------


def install_system_packages(for_tests: bool) -> None:
    """Install the few system packages that are missing, or name them in one sentence where we may not."""
    if not sys.platform.startswith("linux"):
        return
    missing = [package for package, library in LIBRARIES.items() if not loads(library)]
    if for_tests:
        missing += [package for package, program in TEST_PROGRAMS.items() if not shutil.which(program)]
        missing += [package for package, plugin in ALSA_PLUGINS.items() if not has_alsa_plugin(plugin)]
    if not missing:
        return
    if may_install() and apt_install(missing):
        return
    say(f"some system libraries are missing; on Debian and Ubuntu: sudo apt-get install {' '.join(missing)}")


def loads(library: str) -> bool:
    """Tell whether the dynamic linker finds a library."""
    with contextlib.suppress(OSError):
        ctypes.CDLL(library)
        return True
    return False


def has_alsa_plugin(name: str) -> bool:
    """Tell whether ALSA finds a plugin; it loads them by path, not by the linker's search."""
    folders = (Path("/usr/lib/alsa-lib"), Path("/usr/lib64/alsa-lib"), *Path("/usr/lib").glob("*/alsa-lib"))
    return any((folder / name).exists() for folder in folders)


def may_install() -> bool:
    """Tell whether this is a Debian on which this user may install packages without being asked."""
    return hasattr(os, "geteuid") and os.geteuid() == 0 and shutil.which("apt-get") is not None


def apt_install(packages: list[str]) -> bool:
    """Install Debian packages; returns whether that went well."""
    say("installing system packages: " + " ".join(packages))
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    for command in (["apt-get", "update", "-qq"], ["apt-get", "install", "-y", "-qq", *packages]):
        if subprocess.call(command, env=environment, stdout=subprocess.DEVNULL) != 0:
            return False
    return True


# --- the two commands -----------------------------------------------------------------------------------------------


def run(arguments: list[str]) -> int:
    """Start Leakline: the demonstration where nothing else is asked, without a window where there is no display."""
    if not arguments:
        arguments = ["demo"] if has_display() else ["demo", "--out", str(ROOT / "leakline-demo-report")]
    return subprocess.call([str(PYTHON), "-m", "app", *arguments])


def has_display() -> bool:
    """Tell whether a window can be opened."""
    if not sys.platform.startswith("linux"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def test(arguments: list[str]) -> int:
    """Run all checks, each even if one before it failed, the tests last; returns 0 if all passed."""
    checks = {
        "style": ["ruff", "check", "."],
        "format": ["ruff", "format", "--check", "."],
        "types": ["mypy"],
    }
    failed = []
    for name, command in checks.items():
        say(f"checking {name}")
        if subprocess.call([str(PYTHON), "-m", *command], cwd=ROOT) != 0:
            failed.append(name)
    say("checking tests")
    if not (all_tests() if not arguments else pytest(*arguments) == 0):
        failed.append("tests")
    if failed:
        say("failed: " + ", ".join(failed))
    return 1 if failed else 0


def all_tests() -> bool:
    """Run the tests on all processors; a few that fail there have a second chance alone, and it is said which.

    Some of them listen to a real sound server and real terminals in real time: a machine that was busy for a moment is
    no fault of the program. What fails alone, too, has failed.
    """
    (ROOT / LAST_FAILED).unlink(missing_ok=True)
    status = pytest("-n", "auto", "--dist", "worksteal", limit_s=PARALLEL_S)
    if status == 0:
        return True
    if status is None:
        say(f"the tests did not end within {PARALLEL_S / 60:.0f} minutes; they are run again one after the other")
        return pytest() == 0
    try:
        again = sorted(json.loads((ROOT / LAST_FAILED).read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return False
    if not 0 < len(again) <= SECOND_CHANCES:
        return False
    say(f"running again alone what failed: {len(again)}")
    if pytest(*again) != 0:
        return False
    say("passed only when run alone: " + ", ".join(again))
    return True


def pytest(*arguments: str, limit_s: float | None = None) -> int | None:
    """Return the exit status of pytest, None where it did not end in time; then it and its children are killed."""
    command = [str(PYTHON), "-m", "pytest", *arguments]
    with subprocess.Popen(command, cwd=ROOT, start_new_session=os.name == "posix") as running:
        try:
            return running.wait(limit_s)
        except BaseException as ended:
            if os.name == "posix":
                os.killpg(running.pid, signal.SIGKILL)
            running.kill()
            if isinstance(ended, subprocess.TimeoutExpired):
                return None
            raise


def say(sentence: str) -> None:
    """Tell the developer what is happening."""
    print(f"leakline: {sentence}", flush=True)


if __name__ == "__main__":
    try:
        raise SystemExit(main(sys.argv[1:]))
    except KeyboardInterrupt:
        raise SystemExit(130) from None
