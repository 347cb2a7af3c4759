"""What is measured of scenarios, for tests of the paper's statements and of the study's goals."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from joblib import delayed
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from experiments.command import compute
from experiments.maes2018.clock_offset import find_offset
from experiments.maes2018.processing import (
    COLUMNS,
    ROTATIONS,
    Motions,
    find_angles_as_printed,
    process,
)
from experiments.maes2018.scenarios import COASTING, REFERENCE, Record, compose_cell, simulate
from owtsweep.arrays import Array
from owtsweep.estimation.double_integration import RATE, pass_high
from owtsweep.estimation.inertial.angles import (
    find_angles,
    from_heading,
    make_rotation,
    to_heading,
)
from owtsweep.estimation.wahba import carry_point, find_pose
from owtsweep.studies.blade.boom import ENDS, estimate_boom, find_boom_error
from owtsweep.studies.blade.contract import PRISMS, ROOT, UNIT
from owtsweep.studies.blade.measures import compare

#: Filters that should agree, and the smoother.
FILTERS = ("UKF", "MEKF", "INVARIANT_EKF", "SMOOTHER")


def score_reference(record: Record, scheme: str = "SMOOTHER") -> dict[str, float]:
    """Compare both systems of the paper: rms differences in m and deg, and the clock's offset.

    The scheme is that of the inertial system.
    """
    estimates = record.run(scheme)
    motions = process(record.truth, estimates, record.measured)
    keep = motions.time >= record.config.record.settling
    difference = (motions.inertial - motions.stations)[keep]
    found = {
        f"difference_{name}": float(np.sqrt(np.mean(column**2)))
        for name, column in zip(COLUMNS, difference.T, strict=True)
    }
    for name in ROTATIONS:
        found[f"difference_{name}"] = np.rad2deg(found[f"difference_{name}"])
    time = record.measured.step * np.arange(len(estimates.root))
    altitude = carry_point(estimates.root, estimates.rotation, PRISMS[0] - ROOT)[:, 2]
    # positive where the stations' clock is ahead, i.e. shows the blade as it was
    found["offset"] = find_offset(
        time, altitude, record.measured.prism_times, record.measured.prisms[:, 0, 2], 1.0
    )
    wrong = record.config.sensors.prism_offset
    found["offset_error"] = abs(found["offset"] - wrong)
    return found | describe_motion(motions, keep)


def describe_motion(motions: Motions, keep: NDArray[np.bool_]) -> dict[str, float]:
    """Return what the paper says of its figures 9 and 10, of the inertial system's motion."""
    moved = motions.inertial[keep] - motions.inertial[keep].mean(axis=0)
    of = dict(zip(COLUMNS, moved.T, strict=True))

    def rms(values: Array) -> float:
        return float(np.sqrt(np.mean(values**2)))

    def correlate(a: str, b: str) -> float:
        return abs(float(np.corrcoef(of[a], of[b])[0, 1]))

    return {
        "corr_u": correlate("root_u", "cog_u"),
        "difference_u": rms(of["root_u"] - of["cog_u"]) / rms(of["root_u"]),
        "corr_heading": correlate("heading", "root_v"),
        "corr_pitch": correlate("pitch", "root_w"),
        "lateral": rms(of["cog_v"]) / rms(of["root_v"]),
        "vertical": rms(of["cog_w"]) / rms(of["root_w"]),
    }


def score_filter(record: Record, scheme: str) -> dict[str, float]:
    """Return the study's measures of a filter or smoother, and what is left of the heading's sigma.

    That is its standard deviation at the end over that at the start, of filters with a covariance.
    """
    estimates = record.run(scheme)
    found = compare(record.truth, estimates, record.judged)
    if estimates.attitude_covariance is not None:
        sigma = np.sqrt(estimates.attitude_covariance[[0, -1], 2, 2])
        found["heading_kept"] = float(sigma[1] / sigma[0])
    return found


def score_coasting(record: Record, scheme: str) -> dict[str, float]:
    """Return errors at the ends of outages over what P says of them, and the worst one in m."""
    estimates, measured = record.run(scheme), record.measured
    lost = np.isnan(measured.fixes[:, 0, 0]) & measured.due
    due = np.flatnonzero(measured.due)
    ends = due[:-1][lost[due][:-1] & ~lost[due][1:]]
    ends = ends[ends >= record.judged.settled]
    assert estimates.root_covariance is not None
    error = (estimates.root - record.truth.root)[ends]
    variance = np.diagonal(estimates.root_covariance[ends], axis1=1, axis2=2)
    return {
        "end_over_p": float(np.sqrt(np.mean(error**2 / variance))),
        "end_worst": float(np.linalg.norm(error, axis=1).max()),
        "end_rms": float(np.sqrt(np.mean(np.sum(error**2, axis=1)))),
    }


def score_geometry(replicate: int) -> dict[str, float]:
    """Return errors of Wahba's problem without noise, of printed angles, and of extrapolation."""
    draw = np.random.default_rng(replicate)
    rotation = Rotation.random(100, random_state=draw).as_matrix()
    origin = draw.normal(size=(100, 3))
    seen = origin[:, None] + np.einsum("nij,kj->nki", rotation, PRISMS)
    found, turned = find_pose(PRISMS, seen, about="first")
    mirrored = find_pose(PRISMS, (PRISMS * [1.0, 1.0, -1.0])[None])[1]
    angles = draw.uniform(0.01, 0.6, (100, 3)) * draw.choice([-1.0, 1.0], (100, 3))
    small = make_rotation(from_heading(angles))
    safe = to_heading(find_angles(small))
    wrong = np.array([0.1, 0.0, 0.0])  # the unit is believed to be elsewhere on the blade
    unit = carry_point(origin, rotation, UNIT)
    cog = carry_point(unit, rotation, -(UNIT + wrong)) - origin
    root = carry_point(unit, rotation, ROOT - UNIT) - carry_point(origin, rotation, ROOT)
    return {
        "pose": float(max(np.abs(found - origin).max(), np.abs(turned - rotation).max())),
        "reflection": float(np.abs(np.linalg.det(mirrored) - 1.0).max()),
        "printed_angles": float(np.abs(find_angles_as_printed(small) - safe).max()),
        "cog_over_lever": float(np.linalg.norm(cog, axis=1).mean() / np.linalg.norm(wrong)),
        "root_over_lever": float(np.linalg.norm(root, axis=1).max() / np.linalg.norm(wrong)),
    }


def score_boom(record: Record) -> dict[str, float]:
    """Return errors in mm of the boom's tip above .15 Hz, in space, and by how much it moves.

    What is kept of a slow motion of .075 Hz, as a part, too.
    """
    true, felt = record.truth.boom, record.measured.boom
    assert true is not None
    assert felt is not None
    settled = record.config.record.settling
    estimate = estimate_boom(felt)
    forms = {
        "boom": estimate,
        "boom_causal": estimate_boom(felt, zero_phase=False),
        "boom_moved": np.zeros_like(estimate),
    }
    found = {}
    for name, form in forms.items():
        error = find_boom_error(true, form, settled)
        assert error is not None
        found[name] = 1e3 * error
    slow = np.sin(2.0 * np.pi * 0.075 * np.arange(len(estimate)) / RATE)
    inner = slice(round(ENDS * RATE), -round(ENDS * RATE))
    kept = pass_high(slow, RATE)[inner].std() / slow[inner].std()
    return found | {"slow_kept": float(kept)}


class Scenario(NamedTuple):
    """Overrides of the paper's system, the schemes that run, and what is measured of each."""

    words: Sequence[str]
    schemes: tuple[str, ...]
    measure: Callable[[Record, str], dict[str, float]]


SCENARIOS = {
    **{name: Scenario(words, ("SMOOTHER",), score_reference) for name, words in REFERENCE.items()},
    "filters": Scenario((), FILTERS, score_filter),
    "coasting": Scenario(COASTING, ("UKF",), score_coasting),
    "boom": Scenario((), ("DOUBLE_INTEGRATION",), lambda record, _: score_boom(record)),
    "geometry": Scenario((), ("none",), lambda record, _: score_geometry(record.replicate)),
}


def collect(replicates: Sequence[int], overrides: Sequence[str] = ()) -> pd.DataFrame:
    """Run all scenarios; return their scores, as `score` does.

    Records have the numbers `replicates`. Scenarios run side by side, in as many processes as there
    are cores.
    """
    jobs = {f"{name}: judged": delayed(score)(name, replicates, overrides) for name in SCENARIOS}
    return pd.concat(compute(jobs), ignore_index=True)


def score(name: str, replicates: Sequence[int], overrides: Sequence[str] = ()) -> pd.DataFrame:
    """Return the scores of a scenario on records.

    Columns: scenario, scheme ("none" where none runs), measure, replicate, value.
    """
    words, schemes, measure = SCENARIOS[name]
    config = compose_cell([*words, *overrides])  # once, not per record: it takes .1 s
    rows = []
    for replicate in replicates:
        record = simulate(config, replicate)
        for scheme in schemes:
            found = measure(record, scheme)
            rows += [(name, scheme, key, replicate, value) for key, value in found.items()]
    return pd.DataFrame(rows, columns=["scenario", "scheme", "measure", "replicate", "value"])
