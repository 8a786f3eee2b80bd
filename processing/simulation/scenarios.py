"""The named scenarios, in one visible table, and how to load one by its name or from a file."""

from collections.abc import Callable, Mapping
from importlib import resources
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError
from processing.simulation import papers, walks
from processing.simulation.scenario import Scenario
from processing.simulation.scenario_file import read_scenario
from processing.simulation.surveys import long_main, noise_free, random_scenario, small_rolling
from processing.survey import Motion


def demo_scenario() -> Scenario:
    """Return the demonstration survey's scenario, which ships as a file."""
    with resources.as_file(resources.files("resources") / "demo" / "scenario.toml") as path:
        return read_scenario(path)


SCENARIOS: Mapping[str, Callable[[], Scenario]] = {
    "demo": demo_scenario,
    "rolling": small_rolling,
    "long-main": long_main,
    "noise-free-rolling": lambda: noise_free(Motion.ROLLING),
    "noise-free-carried": lambda: noise_free(Motion.CARRIED),
    "p0-straight": papers.p0_straight,
    "p0-closed": papers.p0_closed,
    "p0-50m": papers.p0_50m,
    **{f"p1-{n:02d}": papers.p1_maker(n) for n in range(1, 15)},
    "foot-square": walks.foot_square,
    "foot-circle": walks.foot_circle,
    "foot-stairs": walks.foot_stairs,
}

_DRAWN: Mapping[str, Callable[[int], Scenario]] = {"random": random_scenario, "walk": walks.random_walk}


def load_scenario(path_or_name: str | Path) -> Scenario:
    """Return the scenario named in :data:`SCENARIOS`, of ``random-N``, ``walk-N``, or of a ``.toml``/``.json`` file.

    Raises:
        LeaklineError: SCENARIO_UNKNOWN for a name that is neither; those of :func:`.scenario_file.read_scenario`.
    """
    name = str(path_or_name)
    if name in SCENARIOS:
        return SCENARIOS[name]()
    kind, _, number = name.partition("-")
    if kind in _DRAWN and number.isdecimal() and len(name) < 30:
        return _DRAWN[kind](int(number))
    path = Path(path_or_name)
    if path.suffix.lower() in {".toml", ".json"} or path.exists():
        return read_scenario(path)
    raise LeaklineError(ErrorCode.SCENARIO_UNKNOWN, name=name, known=", ".join(SCENARIOS))
