"""The demonstration survey as a folder on the user's disc: made once from the shipped scenario and a fixed seed."""

import shutil
import tempfile
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.progress import Progress, silent
from processing.settings import digest
from processing.simulation.run import simulate
from processing.simulation.scenarios import demo_scenario
from processing.simulation.writing import write_run

DEMO_SEED = 2026
_MADE = "demo-"
_VERSION = 1  # raise it when the simulator changes what it makes, so that old copies are left behind


def demo_folder(target_dir: Path, progress: Progress | None = None) -> Path:
    """Return the folder of the demonstration survey under ``target_dir``, making it on the first call.

    It appears whole or not at all: it is made aside and renamed, so neither a crash nor a cancel leaves half of it, and
    two programs may ask at once.

    Raises:
        LeaklineError: CANNOT_WRITE where it cannot be made; Cancelled when the operator stops it.
    """
    progress = progress or silent()
    scenario = demo_scenario()
    folder = target_dir / f"{_MADE}{digest(scenario, DEMO_SEED, _VERSION)[:8]}"
    if (folder / "survey.toml").is_file():
        progress.update(1.0)
        return folder
    try:
        target_dir.mkdir(parents=True, exist_ok=True)
        aside = Path(tempfile.mkdtemp(prefix=".making-", dir=target_dir))
    except OSError as error:
        raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(target_dir), reason=error.strerror or str(error)) from error
    try:
        run = simulate(scenario, DEMO_SEED, progress.part(0.0, 0.4, "simulate_motion"))
        write_run(run, aside, progress.part(0.4, 1.0, "write_imu"))
        _put(aside, folder)
    finally:
        shutil.rmtree(aside, ignore_errors=True)
    progress.update(1.0)
    return folder


def _put(aside: Path, folder: Path) -> None:
    try:
        aside.chmod(0o755)  # mkdtemp's are private
        aside.rename(folder)
    except OSError as error:
        if not (folder / "survey.toml").is_file():  # else another program was quicker, and its copy is the same
            raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(folder), reason=error.strerror or str(error)) from error
