"""The command line: words in, exit status out (0 done, 2 bad arguments or input in one line, 1 our own fault)."""

import argparse
import errno
import logging
import os
import re
import signal
import sys
import threading
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn, Self

from processing import messages
from processing.errors import Cancelled, ErrorCode, LeaklineError, Place
from processing.progress import Progress

DONE, OUR_FAULT, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
DEVICE_PROTOCOLS = ("frames", "csv", "printed", "ximu3", "ximu3-binary")  # of app.devices.simulated.protocols, unloaded
HANDOVER_FILES = ("decisions", "excel", "kml", "gpx", "geopackage", "shapefile", "dxf", "raven", "zip")  # of FileKind
DISC_FULL = {errno.ENOSPC, errno.EDQUOT} if hasattr(errno, "EDQUOT") else {errno.ENOSPC}


class OneLineParser(argparse.ArgumentParser):
    """Says what is wrong with the words in one line, as the contract asks."""

    def error(self, message: str) -> NoReturn:
        """Print one line and leave with status 2."""
        self.exit(BAD_INPUT, f"leakline: {message}. See '{self.prog} --help'.\n")


def run(arguments: Sequence[str]) -> int:
    """Do what the words say and return the exit status; never a traceback unless ``--debug``."""
    words = parser().parse_args(arguments)
    logging.basicConfig(level=logging.DEBUG if words.debug else logging.ERROR, format="leakline: %(message)s")
    try:
        return int(words.handler(words))
    except LeaklineError as error:
        return _fail(words, messages.error_sentence(error, words.language), BAD_INPUT)
    except Cancelled:
        return INTERRUPTED
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        return DONE
    except OSError as error:
        return _fail(words, messages.error_sentence(_as_leakline_error(error), words.language), BAD_INPUT)
    except Exception as error:  # noqa: BLE001  # the last net: our fault, said in one line
        kind = type(error).__name__
        return _fail(words, messages.text("cli", "our_fault", words.language, kind=kind, detail=error), OUR_FAULT)


def _fail(words: argparse.Namespace, sentence: str, status: int) -> int:
    if words.debug:
        traceback.print_exc()
    print("leakline: " + " ".join(sentence.split()), file=sys.stderr)
    return status


def _as_leakline_error(error: OSError) -> LeaklineError:
    place = Place(Path(error.filename)) if isinstance(error.filename, str | Path) else None
    if error.errno in DISC_FULL:
        return LeaklineError(ErrorCode.DISC_FULL, place)
    if isinstance(error, FileNotFoundError):
        return LeaklineError(ErrorCode.FILE_MISSING, place)
    return LeaklineError(ErrorCode.FILE_UNREADABLE, place, reason=error.strerror or str(error))


def _place(word: str) -> Path:
    """Return a path; an empty word is a variable that was not set, not the current folder."""
    if not word.strip():
        raise argparse.ArgumentTypeError("it is empty")
    return Path(word)


def _seed(word: str) -> int:
    """Return a seed: a whole number from 0 on."""
    if not (word.isascii() and word.isdecimal() and len(word) <= 30):
        raise argparse.ArgumentTypeError(f"{word[:40]!r} is not a whole number from 0 on")
    return int(word)


def _positive(word: str) -> float:
    """Return a number above 0."""
    number = float(word) if re.fullmatch(r"\d{1,9}(\.\d{0,9})?", word) else 0.0
    if not number > 0.0:
        raise argparse.ArgumentTypeError(f"{word[:40]!r} is not a number above 0")
    return number


def _common_words() -> OneLineParser:
    """Return the words that may stand before and after the command."""
    common = OneLineParser(add_help=False)
    common.add_argument("--debug", action="store_true", default=argparse.SUPPRESS, help="show tracebacks")
    common.add_argument("--language", choices=messages.LANGUAGES, default=argparse.SUPPRESS, help="of what is said")
    return common


def parser() -> OneLineParser:
    """Return the grammar of the command line."""
    common = _common_words()
    top = OneLineParser(
        prog="leakline",
        parents=[_common_words()],  # its own: set_defaults below must not reach those of the commands
        description="Finds water leaks from one run of a sensor ball. Without a command it opens the window.",
    )
    top.set_defaults(debug=False, language="en", handler=_window, path=None)
    commands = top.add_subparsers(title="commands", metavar="COMMAND", parser_class=OneLineParser)

    one = commands.add_parser("open", parents=[common], help="open a survey folder or project in the window")
    one.add_argument("path", type=_place, metavar="PATH")
    one.set_defaults(handler=_window)

    one = commands.add_parser("demo", parents=[common], help="open the bundled demonstration survey")
    one.add_argument("--out", type=_place, metavar="DIR", help="process it without a window and write its files there")
    one.set_defaults(handler=_demo)

    one = commands.add_parser("process", parents=[common], help="do the whole job without a window")
    one.add_argument("path", type=_place, metavar="PATH", help="a device's folder, a single log, or a project")
    one.add_argument("--out", type=_place, metavar="DIR", required=True, help="where the files are written")
    one.add_argument("--set", action="append", default=[], metavar="TABLE.KEY=VALUE", dest="overrides")
    _add_handover(one)
    one.set_defaults(handler=_process)

    one = commands.add_parser("simulate", parents=[common], help="write a simulated survey with its truth")
    one.add_argument("scenario", metavar="SCENARIO", help="a name (see 'leakline scenarios'), or a scenario file")
    one.add_argument("--out", type=_place, metavar="DIR", required=True)
    one.add_argument("--seed", type=_seed, default=0, metavar="N")
    one.set_defaults(handler=_simulate)

    _add_record(commands, common)
    _add_simulate_device(commands, common)

    one = commands.add_parser("scenarios", parents=[common], help="list what can be simulated")
    one.set_defaults(handler=_scenarios)

    one = commands.add_parser("formats", parents=[common], help="list what can be imported")
    one.set_defaults(handler=_formats)
    return top


def _add_handover(process: OneLineParser) -> None:
    listed = ", ".join(HANDOVER_FILES)
    process.add_argument("--files", type=_files, metavar="LIST", help=f"more files: all, or some of {listed}")
    process.add_argument("--crs", metavar="EPSG:N", help="the coordinate system of the map files; alone: all files")


def _files(word: str) -> frozenset[str]:
    """Return the names of files to hand over."""
    names = [name.strip().lower() for name in word.split(",") if name.strip()]
    if names == ["all"]:
        return frozenset(HANDOVER_FILES)
    unknown = next((name for name in names if name not in HANDOVER_FILES), None)
    if unknown is not None or not names:
        raise argparse.ArgumentTypeError(f"{(unknown or word)[:40]!r} is none of all, {', '.join(HANDOVER_FILES)}")
    return frozenset(names)


def _add_record(commands: "argparse._SubParsersAction[OneLineParser]", common: OneLineParser) -> None:
    imu = "serial:/dev/ttyUSB0@115200, serial:auto, tcp:HOST:PORT or udp:PORT; ,protocol=NAME may follow"
    one = commands.add_parser("record", parents=[common], help="record from live devices without a window")
    one.add_argument("--imu", metavar="SPEC", help=f"where the IMU's samples come from: {imu}")
    one.add_argument("--audio", metavar="SPEC", help="the microphone: default, or NAME[@RATE][,channels=N]")
    one.add_argument("--out", type=_place, metavar="PATH", help="the new folder, or one in which it is made")
    one.add_argument("--seconds", type=_positive, metavar="N", help="stop by itself after this time")
    one.add_argument("--wait", type=_positive, default=10.0, metavar="N", help="seconds to wait for the devices (10)")
    one.add_argument("--part-minutes", type=_positive, default=60.0, metavar="N", help="length of a file (60)")
    one.add_argument("--survey", type=_place, metavar="FILE", help="a survey.toml: pipe, launch, route")
    one.add_argument("--name", metavar="TEXT", help="of the survey")
    one.add_argument("--diameter", metavar="METRES", help="of the pipe")
    one.add_argument("--radius", metavar="METRES", help="of the ball")
    one.add_argument("--motion", metavar="WORD", help="how the device moves: rolling, carried or foot")
    one.add_argument("--check", action="store_true", help="check devices and clocks in its first half minute")
    one.add_argument("--list", action="store_true", help="list microphones and serial ports, and record nothing")
    one.set_defaults(handler=_record)


def _add_simulate_device(commands: "argparse._SubParsersAction[OneLineParser]", common: OneLineParser) -> None:
    one = commands.add_parser("simulate-device", parents=[common], help="send a simulated run as a live device would")
    one.add_argument("source", metavar="SOURCE", help="a scenario (see 'leakline scenarios'), or a recording's folder")
    one.add_argument("--imu", default="pty", metavar="PORT", help="pty[:LINK], tcp:[HOST:]PORT or udp:HOST:PORT")
    one.add_argument("--protocol", default="frames", choices=DEVICE_PROTOCOLS, help="how it speaks")
    one.add_argument("--audio", default="none", metavar="OUT", help="SINK (PulseAudio), output:NAME, wav:FILE or none")
    one.add_argument("--start-server", action="store_true", help="start a sound server with a virtual microphone")
    one.add_argument("--rate", type=_positive, metavar="HZ", help="samples of the IMU a second")
    one.add_argument("--audio-rate", type=int, metavar="HZ", help="of a scenario's sound")
    one.add_argument("--channels", type=int, default=1, choices=range(1, 9), metavar="N", help="of a scenario's sound")
    one.add_argument("--speed", type=_positive, default=1.0, metavar="X", help="so many times as fast, without sound")
    one.add_argument("--loop", action="store_true", help="begin anew at the end")
    one.add_argument("--faults", default="", metavar="LIST", help="such as 'garbage@10+2,unplug@30+3,drift=80'")
    one.add_argument("--seed", type=_seed, default=0, metavar="N")
    one.add_argument("--seconds", type=_positive, metavar="N", help="end after so many seconds of sending")
    one.add_argument("--no-wait", action="store_true", help="send from the start, not when somebody listens")
    one.add_argument("--truth", type=_place, metavar="FILE", help="write what was sent, and when")
    one.set_defaults(handler=_simulate_device)


# --- the commands -------------------------------------------------------------------------------------------------


def _window(words: argparse.Namespace) -> int:
    if words.path is not None and not words.path.exists():
        raise LeaklineError(ErrorCode.FILE_MISSING, Place(words.path))
    from app.application import run_window

    return run_window(words.path)


def _demo(words: argparse.Namespace) -> int:
    from app.demonstration import demonstration_folder

    with _TerminalProgress(words.language) as progress:
        folder = demonstration_folder(progress)
    if words.out is None:
        from app.application import run_window

        return run_window(folder)
    return _process_to(folder, words.out, [], words.language)


def _process(words: argparse.Namespace) -> int:
    return _process_to(words.path, words.out, words.overrides, words.language, words.files, words.crs)


def _process_to(
    path: Path,
    out: Path,
    overrides: list[str],
    language: str,
    files: frozenset[str] | None = None,
    crs: str | None = None,
) -> int:
    from app.batch import process_folder
    from app.handover_choices import options_of_words

    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, signal.default_int_handler)  # else the scratch files would stay behind
    with _TerminalProgress(language) as progress:
        outcome = process_folder(path, out, overrides, language, progress, options_of_words(files, crs))
    for finding in outcome.findings:
        print("- " + messages.finding_sentence(finding, language))
    print(messages.text("cli", "processed", language, leaks=len(outcome.candidates), folder=out.resolve()))
    return DONE


def _simulate(words: argparse.Namespace) -> int:
    from processing.simulation.run import simulate
    from processing.simulation.scenarios import load_scenario
    from processing.simulation.writing import write_run

    with _TerminalProgress(words.language) as progress:
        run = simulate(load_scenario(words.scenario), words.seed, progress.part(0.0, 0.5))
        write_run(run, words.out, progress.part(0.5, 1.0))
    print(messages.text("cli", "simulated", words.language, folder=words.out.resolve()))
    return DONE


def _record(words: argparse.Namespace) -> int:
    from app.recording_command import record

    return record(words)


def _simulate_device(words: argparse.Namespace) -> int:
    from app.simulate_device_command import SimulateDeviceWords, print_line, simulate_device

    told = SimulateDeviceWords(
        words.source, words.imu, words.protocol, words.audio, words.rate, words.audio_rate, words.channels,
        words.speed, words.loop, words.faults, words.seed, words.seconds, not words.no_wait, words.start_server,
        words.truth, words.language,
    )  # fmt: skip
    with _TerminalProgress(words.language) as progress:
        simulate_device(told, progress, print_line)
    return DONE


def _scenarios(_words: argparse.Namespace) -> int:
    from processing.simulation.scenarios import SCENARIOS

    for name in SCENARIOS:
        print(name)
    return DONE


def _formats(words: argparse.Namespace) -> int:
    from processing.importing.registry import FORMATS
    from processing.importing.route_files.registry import ROUTE_FORMATS

    for entry in FORMATS:
        print(f"{entry.name:20} {entry.title}")
    print(messages.text("cli", "formats_sound", words.language))
    kinds = dict.fromkeys(f"{entry.title} ({' '.join(entry.suffixes)})" for entry in ROUTE_FORMATS)
    print(messages.text("cli", "formats_route", words.language, formats=", ".join(kinds)))
    return DONE


class _TerminalProgress(Progress):
    """Shows one moving line on a terminal, nothing elsewhere."""

    def __init__(self, language: str) -> None:
        self._language = language
        self._shown = sys.stderr is not None and sys.stderr.isatty() and os.environ.get("TERM") != "dumb"
        super().__init__(self._show if self._shown else None)

    def _show(self, fraction: float, phrase: str) -> None:
        sentence = messages.table("progress", self._language).get(phrase, phrase)
        print(f"\r\x1b[K{fraction:4.0%} {sentence}", end="", file=sys.stderr, flush=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._shown:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)
