"""The same main listened to twice: simulated runs with leaks at will, as processed survey folders."""

from dataclasses import replace

from app.opening import results_of, source_of
from processing.progress import silent
from processing.simulation.run import simulate
from processing.simulation.scenario import Drive, Local, PipeRoute
from processing.simulation.surveys import small_rolling
from processing.simulation.writing import write_run
from processing.storage.folder import SurveyFolder
from processing.survey import LeakClass, Run


def listened(place, name, date, leaks, *, speed_mps=0.6, seed=0, gain_db=0.0):
    """Make a 100 m main with leaks (chainage, dB over the noise), listen to it, process it; return folder and results.

    ``gain_db`` is how much louder the recorder is set: leaks and noise alike.
    """
    base = small_rolling()
    heard = tuple(Local(LeakClass.LEAK, at_m, 1.4, 1500.0, 1.8, snr_db, f"leak {at_m}") for at_m, snr_db in leaks)
    sound = replace(
        base.sound,
        local=heard,
        flow_dbfs=base.sound.flow_dbfs + gain_db,
        rolling_dbfs=base.sound.rolling_dbfs + gain_db,
    )
    route = PipeRoute(((0.0, 0.0, 0.0), (0.0, 60.0, 0.0), (40.0, 60.0, 0.4)), bend_radius_m=0.9)
    scenario = replace(base, name=name, route=route, drive=Drive(speed_mps=speed_mps), sound=sound)
    run = simulate(scenario, seed)
    device = place / f"device {name}"
    device.mkdir(parents=True)
    write_run(run, device)
    survey = replace(run.survey, info=replace(run.survey.info, name=name, date=date))
    folder = SurveyFolder.create(place, survey, [device / "imu.csv", device / "audio.wav"])
    results = results_of(source_of(folder), silent())
    folder.review.add_run(Run(0, "", results.run_hash), results.candidates)
    return folder, results
