"""A simulated run past many leaks, weak and strong, as a survey folder that a review can be done on."""

from dataclasses import replace

import numpy as np

from processing.simulation.run import simulate
from processing.simulation.scenario import Drive, Local, Marker, PipeRoute
from processing.simulation.surveys import small_rolling
from processing.simulation.writing import write_run
from processing.survey import LeakClass

APART_M = 18.0


def many_leaks(count):
    """Return a straight run of ``count`` places that sound, every fifth one a valve, 18 m apart."""
    rng = np.random.default_rng(6)
    kinds = [LeakClass.VALVE if k % 5 == 4 else LeakClass.LEAK for k in range(count)]
    places = tuple(
        Local(
            kind, APART_M * (k + 1), 1.0, 180.0 if kind is LeakClass.VALVE else 1500.0, 1.8, float(rng.uniform(7, 16))
        )
        for k, kind in enumerate(kinds)
    )
    length_m = APART_M * (count + 1)
    base = small_rolling()
    return replace(
        base,
        name="many-leaks",
        route=PipeRoute(((0.0, 0.0, 0.0), (0.0, length_m, 0.0)), bend_radius_m=0.9),
        drive=Drive(speed_mps=0.8),
        sound=replace(base.sound, local=places),
        markers=(Marker("valve chamber", length_m / 2, 0.2), Marker("retrieval", sigma_m=0.2)),
        paperwork=replace(base.paperwork, title="Many leaks (simulated)"),
    )


def write_many_leaks(folder, count=26):
    """Write the device folder of such a run into ``folder``."""
    write_run(simulate(many_leaks(count), 1), folder)
