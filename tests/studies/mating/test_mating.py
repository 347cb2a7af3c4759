"""The mating study: relative motion and chances, from records of two other studies."""

from __future__ import annotations

import runpy
import shutil
from pathlib import Path

import numpy as np
import pytest

import owtsweep
from owtsweep.cli import main
from owtsweep.studies import compose
from owtsweep.studies.mating.config import Limits
from owtsweep.studies.mating.joining import Relative, find_estimated_motion, find_true_motion
from owtsweep.studies.mating.measures import compare, compare_chances, find_chances
from owtsweep.sweep.store import decode, encode

EXAMPLE = Path(__file__).parents[3] / "examples" / "mating.py"
QUICK = ["study=mating", "experiment=quick", "record.duration=60", "record.settling=20"]


WIDE, NARROW = Limits(distance=0.2, speed=0.12), Limits(distance=0.1, speed=0.1)


def _wander(seed: int, steps: int = 400) -> tuple[np.ndarray, np.ndarray]:
    draw = np.random.default_rng(seed)
    return np.cumsum(draw.normal(0.0, 0.02, (steps, 3)), axis=0), draw.normal(0.0, 0.05, (steps, 3))


@pytest.mark.parametrize("hold", [1, 2, 7])
def test_chances_by_brute_force(hold: int) -> None:
    apart, velocity = _wander(1)
    together = [
        np.linalg.norm(p) <= 0.2 and np.linalg.norm(v) <= 0.12
        for p, v in zip(apart, velocity, strict=True)
    ]
    expected = [all(together[k : k + hold]) for k in range(len(together) - hold + 1)]
    assert any(expected)
    assert find_chances(apart, velocity, WIDE, hold).tolist() == expected


def test_a_record_shorter_than_a_mating() -> None:
    with pytest.raises(ValueError, match="3 samples are fewer than the 4 of a mating"):
        find_chances(np.zeros((3, 3)), np.zeros((3, 3)), NARROW, 4)


def test_shares_of_chances() -> None:
    true = np.array([1, 1, 1, 0, 0, 0, 0, 0], bool)
    told = np.array([1, 0, 0, 1, 0, 0, 0, 0], bool)
    shares = {"wrong": 3 / 8, "chance": 3 / 8, "told": 2 / 8, "missed": 2 / 3, "false": 1 / 2}
    assert compare_chances(true, told) == pytest.approx(shares)
    never = compare_chances(np.zeros(4, bool), np.zeros(4, bool))
    assert (never["chance"], never["told"], never["wrong"]) == (0.0, 0.0, 0.0)
    assert np.isnan(never["missed"])
    assert np.isnan(never["false"])


def test_a_perfect_estimate_is_never_wrong() -> None:
    true = Relative(*_wander(2))
    found = compare(true, true, WIDE, 3, settled=50)
    assert found["relative"] == found["speed"] == found["wrong"] == found["missed"] == 0.0
    assert found["chance"] == found["told"] > 0.0


def test_measures_are_those_of_the_settled_part() -> None:
    """Of ten settled samples three are chances; one of them is told, and one that is none."""
    apart = np.full((30, 3), [1.0, 0.0, 0.0])
    true, said = apart.copy(), apart.copy()
    true[[20, 21, 22]] = said[[20, 25]] = 0.0
    still, fast = np.zeros((30, 3)), np.full((30, 3), [0.0, 0.0, 9.0])
    fast[20:] = [0.0, 0.06, 0.0]
    found = compare(Relative(true, still), Relative(said, fast), NARROW, 1, settled=20)
    expected = {
        "relative": np.sqrt(3 / 10), "speed": 0.06, "wrong": 3 / 10, "chance": 3 / 10,
        "told": 2 / 10, "missed": 2 / 3, "false": 1 / 2,
    }  # fmt: skip
    assert found == pytest.approx(expected)


def test_nees_of_drawn_errors() -> None:
    steps = 20_000
    true = Relative(np.zeros((steps, 3)), np.zeros((steps, 3)))
    P = np.array([[4.0, 1.0, 0.0], [1.0, 2.0, 0.5], [0.0, 0.5, 1.0]])
    error = np.random.default_rng(3).multivariate_normal(np.zeros(3), P, steps)
    told = Relative(error, error, np.broadcast_to(P, (steps, 3, 3)))
    found = compare(true, told, NARROW, 1, settled=0)
    assert found["nees"] == pytest.approx(1.0, abs=0.03)


def test_relative_motion_is_that_of_both_records() -> None:
    """North of the hub is x of the blade, east is against its y; nothing moves the hub upwards."""
    of_both = ["record.duration=30", "seed=5"]
    blade = owtsweep.estimate(
        [
            "study=blade", "experiment=held", "grid.sigma=[0.01]", "grid.outage=[0]",
            "record.settling=5", "schemes=[MEKF]", *of_both,
        ]
    )  # fmt: skip
    hub = owtsweep.estimate(
        [
            "study=hub", "tuning=matched", "grid.natural_period=[4]", "grid.amplitude=[0.1]",
            "schemes=[MKF]", *of_both,
        ]
    )  # fmt: skip
    moved = hub.truth["position"][::2]
    root = blade.truth["root"] - [-17.93, 0.0, 0.0]
    true = find_true_motion(blade, hub)
    np.testing.assert_allclose(true.position[:, 0], root[:, 0] - moved[:, 0], atol=1e-12)
    np.testing.assert_allclose(true.position[:, 1], root[:, 1] + moved[:, 1], atol=1e-12)
    np.testing.assert_allclose(true.position[:, 2], root[:, 2], atol=1e-12)
    rates = np.gradient(true.position, blade.time, axis=0)
    np.testing.assert_allclose(true.velocity[1:-1], rates[1:-1], atol=2e-3)
    told = find_estimated_motion(blade, "MEKF", hub, "MKF")
    P = hub.covariances["MKF"]["position"][::2][-1]
    assert told.covariance is not None
    added = told.covariance[-1] - blade.covariances["MEKF"]["root"][-1]
    np.testing.assert_allclose(added[:2, :2], [[P[0, 0], -P[0, 1]], [-P[1, 0], P[1, 1]]])
    np.testing.assert_allclose(added[2], 0.0)


def test_a_sweep_from_plan_to_pictures(tmp_path: Path) -> None:
    run = owtsweep.run([*QUICK, f"results={tmp_path}"])
    rows = run.cases()
    assert set(rows["status"]) == {"ok"}
    chance = rows[rows["measure"] == "chance"].groupby(["replicate"], observed=True)["value"]
    assert (chance.nunique() == 1).all()  # the truth does not depend on sensors
    best = run.best_scheme()
    assert set(best["criterion"]) == {"relative", "speed", "wrong"}
    calm = best[(best["criterion"] == "relative") & (best["outage"] == 20.0)]
    assert set(calm["best"].astype(str)) == {"PENDULUM"}


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two runs of one cell, early and late."""
    folder = tmp_path_factory.mktemp("pair")
    cell = ["grid.sigma=[0.01]", "grid.outage=[0]", "schemes=[MEKF_HEADING,HOLD]"]
    cell += ["record.duration=30", "record.settling=10"]
    for seed, name in enumerate(("early", "late")):
        owtsweep.run([*QUICK, *cell, f"seed={seed}", f"results={folder}", f"name={name}"])
    return folder


USELESS = "owtsweep: runs: none has a finite number of MEKF_HEADING, HOLD in a cell"


@pytest.mark.parametrize(
    ("column", "value", "told"),
    [
        ("value", np.nan, USELESS), ("value", np.inf, USELESS), ("value", -np.inf, USELESS),
        ("scheme", "OTHER", USELESS),
        ("measure", "OTHER", "owtsweep: rows: two values for one case"),
        *((name, None, "no run has a succeeded case") for name in ("value", "scheme", "sigma")),
    ],
)  # fmt: skip
def test_sealed_rows_that_cannot_be_compared_are_one_line(
    pair: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    column: str,
    value: object,
    told: str,
) -> None:
    """The seal of a shard shows damage, not forgery. The value None takes the column away."""
    for name in ("early", "late"):
        run = owtsweep.load(shutil.copytree(pair / name, tmp_path / name))
        for key in run.plan():
            path = run.store.path(key)
            rows = decode(path.read_bytes(), key, {}).to_pandas()
            rows = rows.drop(columns=column) if value is None else rows.assign(**{column: value})
            path.write_bytes(encode(key, rows, {}))
    assert main(["compare", str(tmp_path / "early"), str(tmp_path / "late")]) == 2
    *warnings, last = capsys.readouterr().err.splitlines()
    assert last.startswith("owtsweep: ")
    assert told in last
    assert all("holds no rows of this study: " in line for line in warnings)
    assert bool(warnings) == (value is None)  # each such shard is named


@pytest.mark.parametrize(
    ("override", "told"),
    [
        ("record.rate=30", "record.rate: 30 Hz do not divide the 100 Hz of the hub's IMU; "),
        ("grid.hold=[500]", "grid.hold: 500 s are more than half of the 40 s that are judged; "),
        ('blade=["grid.sigma=[1]"]', "blade: grid.sigma is set by the mating study; "),
        ('hub=["seed=3"]', "hub: seed is set by the mating study; "),
        ("hub=[]", "hub: grid.natural_period has 6 values, and the mating study takes one; "),
        ('hub=["motion=plant"]', "hub: motion.hs has 6 values, and the mating study takes one; "),
        ('hub=["grid.perod=[3]"]', "hub: grid.perod: there is no such key"),
        ("hub_scheme=XX", "hub: schemes: there is no scheme 'XX'"),
        ("schemes=[FOO]", "blade: schemes: there is no scheme 'FOO'"),
        ("tuning=nope", "blade: tuning: there is no 'nope'"),
    ],
)
def test_what_cannot_be_joined(override: str, told: str) -> None:
    with pytest.raises(owtsweep.InputError) as error:
        compose([*QUICK, override])
    assert str(error.value).startswith(told)


def test_the_example_shows_one_record(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    example = runpy.run_path(str(EXAMPLE))["main"]
    monkeypatch.chdir(tmp_path)
    assert example(["20"]) == 0
    told = capsys.readouterr().out.splitlines()
    errors = {line.split()[0]: float(line.split()[1]) for line in told[2:5]}
    assert errors["PENDULUM"] < errors["HOLD"]
    assert (tmp_path / "mating.png").stat().st_size > 10_000
    assert example(["x"]) == 2
    assert capsys.readouterr().err == "mating.py: grid.outage[0]: 'x' is not a number\n"
