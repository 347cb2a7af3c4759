"""Measure what the tower study costs: a record, a filter over it, the damage of its welds, a sweep.

    python -m benchmarks.tower [--study]

All but the sweep (`--study`, minutes) run on one thread in this process. filterpy runs over the
first steps of the same record with the same matrices, and its estimates must agree. They are
compared where sensors see: strains and loads at the cuts, after the first second. (Position and
velocity of the rigid translation, which inclinometers and accelerometers do not see, drift by
rounding.)
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import ROOT
from benchmarks.timing import seconds, timed
from owtsweep.estimation.augmented import augment_walks
from owtsweep.structures.fatigue import compute_damage
from owtsweep.studies import compose
from owtsweep.studies.tower.case import Case, list_channels, make_case, measure
from owtsweep.studies.tower.contract import DIRECTIONS, Setting
from owtsweep.studies.tower.models import Model
from owtsweep.studies.tower.schemes import SCHEMES
from owtsweep.studies.tower.schemes.filtered import find_noise
from owtsweep.studies.tower.setting import make_setting

#: Greatest times: of a filter over a record in one direction (gains at hand), of the damage of all
#: welds in both directions, and of the default study on two cores, s; greatest memory of the study,
#: MB; least ratio to filterpy.
FILTER, DAMAGE, STUDY, MEGABYTES, FASTER = 0.5, 0.2, 300.0, 2000.0, 20.0
#: filterpy's estimates count as the same if they differ by this part of their standard deviation,
#: after so many steps.
AGREEMENT, FIRST = 1e-6, 100
#: Steps over which filterpy is timed, and the noise of the sensors in %.
PEER_STEPS, NOISE = 2000, 1.0
#: Time between looks at the memory of a running study, s.
LOOK = 2.0


@dataclass(frozen=True)
class Job:
    """A record, and what schemes get of one direction: setting, measurements (steps, channels)."""

    config: Any
    case: Case
    setting: Setting
    measured: np.ndarray


def make_job(*overrides: str, direction: str = "fa") -> Job:
    """Make the first record of the default study, with overrides."""
    config: Any = compose(["study=tower", *overrides])
    case = make_case(config, 0)
    channels = list_channels(config, case, direction, NOISE)
    motion = case.motion[direction]
    setting = make_setting(config, case.part, direction, 1.0, channels, motion)
    return Job(config, case, setting, measure(config, case, direction, channels))


def main(*, study: bool) -> None:
    """Print all measurements beside their goals."""
    for sea in ("calm", "waves_30"):
        config: Any = compose(["study=tower", f"sea={sea}"])
        spent = seconds(partial(make_case, config, 0), repeats=3)
        print(f"truth and signals, both directions, sea={sea}: {spent:.2f} s")
    job = make_job("sea=waves_30")
    for name in ("AKF", "AKF_WAVE"):
        print_filter(name, job)
    print_damage(job)
    if study:
        print_study()


def print_filter(name: str, job: Job) -> None:
    """Print the times of a scheme's gains and of its run over a record, beside filterpy's."""
    scheme: Any = SCHEMES.resolve(name)
    prepared, gains = timed(lambda: scheme.prepare(job.setting))
    spent = seconds(lambda: prepared.run(job.measured))
    alone = seconds(lambda: prepared.filter.run(job.measured))
    steps = len(job.measured)
    theirs, peer = timed(lambda: filter_by_peer(scheme, job, min(PEER_STEPS, steps)))
    ours = prepared.filter.run(job.measured[: len(theirs)])
    apart = compare(scheme.model(job.setting), job.setting, ours, theirs)
    each = peer.wall / len(theirs)
    verdict = "agrees" if apart <= AGREEMENT else "DIFFERS"
    print(
        f"{name}, {theirs.shape[1]} states: gains {gains.wall:.2f} s; over {steps} steps "
        f"{alone:.3f} s, with displacements and loads {spent:.3f} s per direction (goal {FILTER:g} "
        f"s); filterpy {each * steps:.1f} s, {each * steps / alone:.0f} times as long (goal "
        f"{FASTER:g}), and {verdict} (largest difference {apart:.0e} of a standard deviation)"
    )


def compare(model: Model, setting: Setting, ours: np.ndarray, theirs: np.ndarray) -> float:
    """Return the largest difference of strains and loads, in standard deviations of `theirs`."""
    seen = []
    for both in (ours, theirs):
        read = model.read(both[:, : 2 * model.modes], both[:, 2 * model.modes :])
        strains = read.displacement @ setting.strain.T
        seen.append(np.hstack([strains, read.inputs])[FIRST:])
    # At free ends of the reduced structure, a strain may be zero but for rounding.
    size = np.std(seen[1], axis=0)
    size[:-4] = size[:-4].max()
    return float(np.max(np.abs(seen[0] - seen[1]) / size))


def filter_by_peer(scheme: Any, job: Job, steps: int) -> np.ndarray:
    """Run filterpy's Kalman filter over the first steps; return states and inputs, (steps, N)."""
    from filterpy.kalman import KalmanFilter

    setting = job.setting
    model = scheme.model(setting)
    noise = find_noise(setting, model)
    F, H, Q = augment_walks(model.discrete, noise.Q, noise.S)
    peer = KalmanFilter(dim_x=len(F), dim_z=len(H))
    peer.F, peer.H, peer.Q, peer.R, peer.P = F, H, Q, noise.R, noise.P0
    found = np.empty((steps, len(F)))
    for k in range(steps):
        peer.predict()
        peer.update(job.measured[k])
        found[k] = peer.x[:, 0]
    return found


def print_damage(job: Job) -> None:
    """Print the time of the damage of all welds, in both directions."""
    config, settled = job.config, job.config.record.settled
    curves = config.fatigue.find_curves(job.case.part.cut.heights)
    stress = [
        job.case.motion[direction].displacement[settled:] @ job.case.part.stress.T
        for direction in DIRECTIONS
    ]
    spent = seconds(
        lambda: [compute_damage(s, curves, config.fatigue.ultimate_strength) for s in stress]
    )
    welds, steps = 2 * stress[0].shape[1], len(stress[0])
    print(f"damage of {welds} welds, {steps} steps: {spent:.3f} s (goal {DAMAGE:g} s)")


def print_study() -> None:
    """Run the default study as a command; print its time and memory."""
    with tempfile.TemporaryDirectory() as results:
        command = [
            sys.executable, "-m", "owtsweep", "sweep", "study=tower", f"results={results}",
            "compute.workers=2",
        ]  # fmt: skip
        begun, peak = time.perf_counter(), 0.0
        with subprocess.Popen(command, cwd=ROOT) as running:
            while running.poll() is None:
                peak = max(peak, sum(map(read_memory, list_family(running.pid))))
                time.sleep(LOOK)
        wall = time.perf_counter() - begun
    if running.returncode:
        raise SystemExit(running.returncode)
    print(
        f"default study: {wall:.0f} s with two workers (goal {STUDY:g} s), {peak:.0f} MB in all "
        f"its processes (goal {MEGABYTES:g} MB)"
    )


def list_family(process: int) -> Iterator[int]:
    """Yield a process and all its descendants (Linux; elsewhere, the process alone)."""
    yield process
    for children in Path(f"/proc/{process}/task").glob("*/children"):
        try:
            for child in children.read_text().split():
                yield from list_family(int(child))
        except OSError:  # it has just ended
            continue


def read_memory(process: int) -> float:
    """Return the resident memory of a process in MB, shared pages divided among their users."""
    try:
        lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0.0
    return sum(int(line.split()[1]) for line in lines if line.startswith("Pss:")) * 1024 / 1e6


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--study", action="store_true", help="run the default study, too")
    main(study=parser.parse_args().study)
