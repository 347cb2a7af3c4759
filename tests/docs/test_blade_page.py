"""Numbers of docs/blade.md and docs/mating.md are those of the kept tables, and of the script."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hanging import make, run

from owtsweep.studies.blade.cases import Case
from owtsweep.studies.blade.contract import Setting, Start
from owtsweep.studies.blade.doubts import EARTH_RATE
from owtsweep.studies.blade.schemes import SCHEMES
from owtsweep.studies.blade.schemes.mekf import Navigator

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "results" / "reference"
PAGE = " ".join((ROOT / "docs/blade.md").read_text("utf-8").split())
MATING = " ".join((ROOT / "docs/mating.md").read_text("utf-8").split())
SCRIPT = ROOT / "experiments" / "blade" / "left_out.py"
OUTAGES = (0, 10, 40)


def find(pattern: str, text: str = PAGE) -> list[float]:
    """Return the numbers that a pattern's groups match."""
    matched = re.search(pattern, text)
    assert matched is not None, pattern
    return [float(number) for number in matched.groups()]


def read_row(number: int, cells: int, outage: int) -> list[str]:
    """Return the cells of the row of an outage in the table `number`, 0 or 1, that has it."""
    rows = re.findall(rf"\| {outage} s \| ([^|]+(?: \| [^|]+){{{cells - 1}}}) \|", PAGE)
    return [cell.strip() for cell in rows[number].split("|")]


def test_the_table_of_root_errors() -> None:
    found = {}
    for unit in ("fog", "tactical", "mems"):
        table = pd.read_csv(KEPT / f"blade/summary_sigma_outage_{unit}.csv")
        table = table.query("measure == 'root' and sigma == 0.01")
        for outage in OUTAGES:
            at = table[table["outage"] == outage].set_index("scheme")["mean"]
            found[unit, outage] = 1e3 * at
    told = re.findall(r"\| ([A-Z_]+)[^|]* ((?:\| [\d.]+ ){9})\|", PAGE)
    assert len(told) == 12
    for scheme, numbers in told:
        for number, errors in zip(re.findall(r"[\d.]+", numbers), found.values(), strict=True):
            tolerance = 0.051 if "." in number else 0.51
            assert float(number) == pytest.approx(errors[scheme], abs=tolerance), scheme


@pytest.fixture(scope="module")
def hooks() -> pd.DataFrame:
    table = pd.read_csv(KEPT / "blade/moving_hook.csv")
    return table.set_index(["scheme", "hook", "outage"]).sort_index()


def test_pendulum_is_recommended_below_a_hook_at_rest_alone() -> None:
    assert "below a hook at rest" in SCHEMES.describe()["PENDULUM"]
    assert "Without GNSS, and below a hook at rest, run the filter that knows how" in PAGE


@pytest.mark.parametrize("outage", OUTAGES)
def test_what_a_moving_hook_costs(outage: int, hooks: pd.DataFrame) -> None:
    told = [float(cell) for cell in read_row(0, 5, outage)]
    names = ("at rest", "hoisted at .05 m/s", "hoisted at .1 m/s", "sways 1 m in 100 s")
    found = [hooks.loc[("PENDULUM", name, outage), "root"] for name in names]
    mekf = [hooks.loc[("MEKF", name, outage), "root"] for name in names]
    assert told == pytest.approx(1e3 * np.array([mekf[0], *found]), abs=0.5)
    assert mekf == pytest.approx(mekf[:1] * 4, rel=1e-3)


def test_pendulum_does_not_know_its_error_while_the_hook_moves(hooks: pd.DataFrame) -> None:
    nees = hooks.loc["PENDULUM"]["nees"]
    told = find(r"NEES over 3 is (\.\d) to (\d\.\d) at rest, (\d+) to (\d+) at \.05 m/s")
    found = [f(nees[name]) for name in ("at rest", "hoisted at .05 m/s") for f in (min, max)]
    assert told == pytest.approx(found, rel=0.05)
    assert np.sqrt(nees["sways 1 m in 100 s", 40]) == pytest.approx(3.0, abs=0.3)
    pendulum, mekf = (hooks.loc[s, "hoisted at .1 m/s"]["root"] for s in ("PENDULUM", "MEKF"))
    (told,) = find(r"outages of 40 s PENDULUM has (\d\.\d) m there")
    assert told == pytest.approx(pendulum[40], abs=0.05)
    pattern = r"at \.1 m/s, PENDULUM has (\d+) mm with GNSS, MEKF (\d+) mm"
    assert find(pattern) == pytest.approx([1e3 * pendulum[0], 1e3 * mekf[0]], abs=0.5)


@pytest.mark.parametrize("outage", OUTAGES)
def test_what_earths_rotation_costs(outage: int) -> None:
    table = pd.read_csv(KEPT / "blade/earth.csv").set_index(["unit", "earth", "outage", "scheme"])
    cells = iter(read_row(-1, 8, outage))
    for unit, several in (("fog", True), ("tactical", True), ("mems", False)):
        for earth in ("at rest", "turns", *(["taken for a bias"] if several else [])):
            found = table.loc[(unit, earth, outage, "MEKF")]
            root, _, nees = next(cells).partition(" (")
            assert float(root) == pytest.approx(1e3 * found["root"], abs=0.5)
            if earth != "at rest":
                assert float(nees.rstrip(")")) == pytest.approx(found["nees"], rel=0.06)


def test_chances_with_either_scheme_on_the_hub() -> None:
    """Kalman filters on the blade, 1 cm on both, and what a better receiver changes."""
    shares = {}
    for scheme, name in (("HME1", "sigma_hub"), ("SKFA", "sigma_hub_skfa")):
        table = pd.read_csv(KEPT / f"mating/summary_{name}.csv")
        filters = table["scheme"].isin(["UKF", "MEKF_HEADING", "PENDULUM"])
        for measure in ("missed", "false"):
            chosen = (
                100.0
                * table[filters & (table["measure"] == measure)]
                .set_index(["sigma", "hub_sigma", "scheme"])["mean"]
                .sort_index()
            )
            shares[scheme, measure] = chosen
    here = {key: table[0.01, 0.01] for key, table in shares.items()}
    least, *told, low, high, false = find(
        r"HME1 on the hub misses (\d+) % of the chances, and (\d+) to (\d+) % of those that it "
        r"tells are none\. SKFA on the hub \(`hub_scheme=SKFA`\) misses (\d+) to (\d+) %, and "
        r"(\d+) % of those that it tells are none",
        MATING,
    )
    assert here["HME1", "missed"].to_numpy() == pytest.approx(least, abs=0.5)
    for key, both in ((("HME1", "false"), told), (("SKFA", "missed"), [low, high])):
        assert [here[key].min(), here[key].max()] == pytest.approx(both, abs=0.5)
    assert here["SKFA", "false"].to_numpy() == pytest.approx(false, abs=0.5)
    for measure in ("missed", "false"):
        for better in ((0.01, 0.005), (0.003, 0.01)):
            change = shares["SKFA", measure][better] - here["SKFA", measure]
            assert change.abs().max() < 2.0
    assert (here["HME1", "missed"] - shares["HME1", "missed"][0.01, 0.005]).min() > 4.0


def _take(*words: str) -> tuple[Case, Setting]:
    _, motion, measured, setting = make("unit=tactical", "schemes=[MEKF]", *words)
    start = Start(setting.start, setting.start_sigma, setting.geometry)
    case = Case(motion.truth, measured, start)
    return case, setting


def test_the_script_moves_hook_and_sensors_together() -> None:
    """MEKF errs by the same, PENDULUM by far more: only the middle of the swing has moved."""
    script = runpy.run_path(str(SCRIPT))
    case, setting = _take()
    time = case.truth.step * np.arange(len(case.truth.root))
    sway = 1.0 - np.cos(0.02 * np.pi * time)
    moved = script["move_hook"](case, np.column_stack([0.0 * time, sway, 0.2 * time]))
    for name, most, least in (("MEKF", 1e-3, 0.0), ("PENDULUM", np.inf, 0.05)):
        before = run(name, setting, case.measured).root - case.truth.root
        told = script["replace"](setting, start=moved.start.pose)
        after = run(name, told, moved.measured).root - moved.truth.root
        assert least <= np.abs(after - before)[1000:].max() <= most


def test_the_script_turns_the_earth() -> None:
    """With next to no noise MEKF finds Earth's rotation as a bias of its gyroscopes."""
    script = runpy.run_path(str(SCRIPT))
    case, setting = _take("unit.rate_sigma=1e-6", "unit.rate_walk=0", "unit.rate_bias=0")
    turned = script["turn_earth"](case)
    told = script["replace"](setting, rate_bias=np.deg2rad(0.0042))
    bias = Navigator(told).filter(turned.measured).states[-1, 13:16]
    latitude = np.deg2rad(script["LATITUDE"])
    earth = np.array([np.cos(latitude), 0.0, np.sin(latitude)])
    found = np.rad2deg(case.truth.rotation[-1] @ bias) / EARTH_RATE
    assert found[:2] == pytest.approx(earth[:2], abs=0.1)  # a heading's drift hardly shows
