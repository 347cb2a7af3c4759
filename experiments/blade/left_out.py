"""What the blade's filters leave out, and what it costs: a hook that moves, and Earth's rotation.

    python -m experiments.blade.left_out [FOLDER] [RECORDS]

FOLDER (default: results/blade_left_out) gets moving_hook.csv and earth.csv, means over RECORDS (10
by default; some four minutes). GNSS of 10 mm, tuning=matched, seed 2018: records with hook and
Earth at rest are those of the maps in docs/blade.md.
"""

from dataclasses import replace

import numpy as np
import pandas as pd

from experiments.command import read_words, show, write
from owtsweep.io.terminal import show_steps, tell_step
from owtsweep.studies import compose
from owtsweep.studies.blade.cases import make_setting, make_world, observe
from owtsweep.studies.blade.contest import CONTEST
from owtsweep.studies.blade.doubts import EARTH_RATE, TAKEN_FOR_BIAS
from owtsweep.studies.blade.measures import Judged, compare
from owtsweep.studies.blade.measuring import find_last_outage
from owtsweep.studies.blade.schemes import SCHEMES

OUTAGES = (0.0, 10.0, 40.0)  # s
#: How the hook moves -> displacement (m), of the time in s; hoisting is along z, sway along y.
HOOKS = {
    "at rest": lambda t: [0.0 * t, 0.0 * t, 0.0 * t],
    "hoisted at .05 m/s": lambda t: [0.0 * t, 0.0 * t, 0.05 * t],
    "hoisted at .1 m/s": lambda t: [0.0 * t, 0.0 * t, 0.1 * t],
    "sways 1 m in 100 s": lambda t: [0.0 * t, np.sin(0.02 * np.pi * t), 0.0 * t],
}
LATITUDE = 52.0  # deg
#: What is kept: root (rms) and worst, both in m, and NEES over 3.
MEASURES = ("root", "worst", "nees")


def move_hook(case, moved):
    """Return a case whose hook moves by `moved` (steps, 3) in m beside all else that moves.

    Attitude and rates stay: the tackle is long.
    """
    truth, step = case.truth, case.truth.step
    velocity = np.gradient(moved, step, axis=0, edge_order=2)
    pull = np.gradient(velocity, step, axis=0, edge_order=2)
    (position, speed), rotation = case.start.pose
    by = {"root": moved, "unit": moved, "root_velocity": velocity, "unit_velocity": velocity}
    shifted = replace(truth, **{name: getattr(truth, name) + shift for name, shift in by.items()})
    force = case.measured.specific_force + np.einsum("nji,nj->ni", truth.rotation, pull)
    fixes = case.measured.fixes + moved[:, None]
    measured = replace(case.measured, fixes=fixes, specific_force=force)
    pose = np.stack([position + moved[0], speed + velocity[0]]), rotation
    start = case.start._replace(pose=pose)
    return case._replace(truth=shifted, measured=measured, start=start)


def turn_earth(case):
    """Return a case whose inertial unit feels that the frame turns with the Earth; x is north.

    Gyroscopes read Earth's rotation as well, accelerometers the Coriolis acceleration; the
    centrifugal acceleration is a part of gravity.
    """
    truth = case.truth
    at = np.deg2rad(LATITUDE)
    earth = np.deg2rad(EARTH_RATE) * np.array([np.cos(at), 0.0, np.sin(at)])
    felt = 2.0 * np.cross(earth, truth.unit_velocity)
    rate = case.measured.rate + np.einsum("nji,j->ni", truth.rotation, earth)
    force = case.measured.specific_force + np.einsum("nji,nj->ni", truth.rotation, felt)
    return case._replace(measured=replace(case.measured, rate=rate, specific_force=force))


def judge(config, changes, schemes, records):
    """Return rows of means over records: change of the case, outage, scheme.

    `changes` is name -> what changes a case, and the configuration that schemes are told.
    """
    rows = []
    for cell in CONTEST.list_cells(config):
        worlds = [make_world(config, cell, number) for number in range(records)]
        cases = [observe(config, cell, world) for world in worlds]
        window = Judged(config.record.settled, find_last_outage(config, cell["outage"]))
        for name, (change, told) in changes.items():
            changed = [change(case) for case in cases]
            for scheme in SCHEMES.resolve_all(schemes):
                prepared = [
                    (case, scheme.prepare(make_setting(told, cell, case.start))) for case in changed
                ]
                found = pd.DataFrame([
                    compare(case.truth, ready.run(case.measured), window)
                    for case, ready in prepared
                ]).mean()  # fmt: skip
                where = {"changed": name, "outage": cell["outage"], "scheme": scheme.name}
                rows.append(where | {measure: found.get(measure) for measure in MEASURES})
    return rows


def configure(*words):
    """Return the configuration of all cells, with overrides."""
    outages = ",".join(str(outage) for outage in OUTAGES)
    return compose(["study=blade", "grid.sigma=[0.01]", f"grid.outage=[{outages}]", *words])


def try_hooks(records):
    """Return the table of hooks that move, with a tactical unit."""
    config = configure("unit=tactical")
    time = np.arange(config.record.steps) / config.record.rate
    changes = {
        name: (lambda case, find=find: move_hook(case, np.column_stack(find(time))), config)
        for name, find in HOOKS.items()
    }
    rows = judge(config, changes, ("HOLD", "MEKF", "PENDULUM"), records)
    return pd.DataFrame(rows).rename(columns={"changed": "hook"})


def try_earth(records):
    """Return the table of inertial units without and with Earth's rotation."""
    tables = []
    for unit in ("fog", "tactical", "mems"):
        tell_step(f"Earth's rotation, unit={unit}")
        config = configure(f"unit={unit}")
        changes = {"at rest": (lambda case: case, config), "turns": (turn_earth, config)}
        if config.unit.rate_bias < EARTH_RATE:
            changes["taken for a bias"] = (
                turn_earth,
                configure(f"unit={unit}", f"unit.rate_bias={TAKEN_FOR_BIAS}"),
            )
        rows = judge(config, changes, ("MEKF", "MEKF_HEADING", "PENDULUM"), records)
        tables.append(pd.DataFrame([{"unit": unit} | row for row in rows]))
    return pd.concat(tables).rename(columns={"changed": "earth"})


def main():
    """Write both tables."""
    folder, records, _ = read_words("results/blade_left_out", 10)
    for name, collect in (("moving_hook", try_hooks), ("earth", try_earth)):
        tell_step(name)
        table = collect(records)
        show(table)
        write(folder, {name: table})


if __name__ == "__main__":
    with show_steps():
        main()
