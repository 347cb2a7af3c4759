"""The expected engine against dense algebra, single lines, records, and its own tables."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import t as student
from tools import SMALL, configure

import owtsweep
from owtsweep.errors import InputError
from owtsweep.io import cache
from owtsweep.motion.source import SpectralSource, lines, translated
from owtsweep.streams import stream
from owtsweep.studies.hub import batch, estimates, known_motion
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.error_curves import inputs, probing
from owtsweep.studies.hub.error_curves.curves import Curves, curves
from owtsweep.studies.hub.error_curves.of_schemes import expected_ratio
from owtsweep.studies.hub.expected import answers, engine
from owtsweep.studies.hub.known_motion import peak_factors
from owtsweep.studies.hub.sensors import Sensors, fix_count
from owtsweep.studies.hub.study import HubStudy

pytestmark = pytest.mark.usefixtures("kernels")

SCHEMES = ("EKF", "MKF", "HME1", "HME2")


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "folder", lambda: tmp_path / "cache")
    cache.KEPT.clear()


def probe_of(name: str, config: HubConfig) -> tuple[Chain, Sensors, int, int]:
    sensors = sensing.sensors(config.sensors)
    steps = round(config.record.duration / sensors.step)
    settled = round(config.measures.settling_time / sensors.step)
    return resolve(name).kernel(Known(sensors, config), steps), sensors, steps, settled


def curves_of(name: str, config: HubConfig) -> Curves:
    chain, sensors, steps, settled = probe_of(name, config)
    return curves(chain, sensors, steps=steps, settled=settled, band=(0.05, 0.6))


@pytest.mark.parametrize("tuning", ["paper", "matched"])
@pytest.mark.parametrize("name", SCHEMES)
def test_noise_is_that_of_the_dense_covariance(name: str, tuning: str) -> None:
    # the response to an impulse in every sample and every fix is the whole linear map
    config = configure("record.duration=47", tuning=tuning)
    chain, sensors, steps, settled = probe_of(name, config)
    fixes = fix_count(steps, sensors.fix_interval)
    force = np.hstack([np.zeros((steps, fixes)), np.eye(steps)])
    positions = np.hstack([np.eye(fixes), np.zeros((fixes, steps))])
    answer = estimates.trajectories(chain, force, positions)[:2]
    found = curves_of(name, config)
    for measure in range(2):
        for window, first in enumerate((0, settled)):
            map_ = answer[measure][first:]
            of_force = map_[:, fixes:]
            of_walk = np.cumsum(of_force[:, ::-1], axis=1)[:, ::-1][:, 1:]  # none at step 0
            exact = [
                sensors.position_sigma**2 * np.sum(map_[:, :fixes] ** 2),
                sensors.force_sigma**2 * np.sum(of_force**2),
                sensors.bias_walk**2 * sensors.step * np.sum(of_walk**2),
            ]
            got = found.noise[:, measure, window] * (steps - first)
            np.testing.assert_allclose(got, exact, rtol=1e-3)
            constant = np.sum(of_force.sum(axis=1) ** 2) / (steps - first)
            assert found.constant[measure, window] == pytest.approx(constant, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "hold"), [*((name, "zero") for name in SCHEMES), ("HME1", "first"), ("HME2", "first")]
)
def test_one_line_simulated(name: str, hold: str) -> None:
    config = configure(f"hme.predictor.hold={hold}", tuning="matched")
    chain, sensors, steps, settled = probe_of(name, config)
    omega, time = 2 * np.pi * 0.2345, sensors.step * np.arange(steps)
    late = time[:: sensors.fix_interval] - sensors.delay * sensors.step
    phases = np.array([0.3, 0.3 + np.pi / 2])  # the mean over two in quadrature is that over all
    truth = np.cos(omega * time[:, None] + phases)
    rate = -omega * np.sin(omega * time[:, None] + phases)
    position, velocity, _ = estimates.trajectories(
        chain, -(omega**2) * truth, np.cos(omega * late[:, None] + phases)
    )
    found = curves_of(name, config).at(np.array([0.2345]))[..., 0]
    for measure, error in enumerate((position - truth, velocity - rate)):
        for window, first in enumerate((0, settled)):
            exact = 2.0 * np.mean(error[first:] ** 2)
            # read off between nodes
            assert found[measure, window] == pytest.approx(exact, rel=1e-2)


def test_an_answer_that_repeats_is_not_run_to_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    config = configure("record.duration=1500", tuning="matched")
    chain, sensors, steps, settled = probe_of("HME1", config)
    probe = inputs.motion(np.array([0.1, 0.33]), sensors)
    space = probing.Workspace(chain, sensors, steps, settled)
    short = space.energies(probe)
    monkeypatch.setattr(probing, "TOLERANCE", 0.0)
    whole = space.energies(probe)
    assert np.any(short != whole)  # it did stop
    np.testing.assert_allclose(short, whole, rtol=1e-6)


def test_sinusoids_made_while_the_chain_runs_are_those_made_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # of a long record, in which sinusoids begin anew and buffers are filled again many times
    config = configure("record.duration=1500", tuning="matched")
    chain, sensors, steps, settled = probe_of("HME1", config)
    assert steps > 10 * probing.BLOCK > 10 * batch.chunk_of(chain)[0]
    omega, time = 2 * np.pi * 0.3, sensors.step * np.arange(steps)
    late = time[:: sensors.fix_interval] - sensors.delay * sensors.step
    truth = np.stack([np.cos(omega * time), np.sin(omega * time)], axis=1)
    fixes = np.stack([np.cos(omega * late), np.sin(omega * late)], axis=1)
    position = estimates.trajectories(chain, -(omega**2) * truth, fixes)[0]
    monkeypatch.setattr(probing, "TOLERANCE", -1.0)  # run to the end
    probe = inputs.motion(np.array([0.3]), sensors)
    found = probing.Workspace(chain, sensors, steps, settled).energies(probe)[0, :, 0]
    squared = (position - truth) ** 2
    np.testing.assert_allclose(found, [squared.sum(), squared[settled:].sum()], rtol=1e-8)


def test_the_ratio_is_that_of_many_records() -> None:
    # narrow and short, so that the records' scatter matters: without it the mean is 6 % off
    band, duration, count = (0.05, 0.6), 120.0, 4000
    shape = translated(4.0, 2.4e-4)
    frequency = lines(band, 2 * duration)[1]
    weight = frequency**4
    rng = np.random.default_rng(11)
    step = 0.25
    time = step * np.arange(round(duration / step))
    amplitude = np.sqrt(shape.density(frequency))
    ratios = []
    basis = np.exp(2j * np.pi * frequency * time[:, None])
    for _ in range(count):
        line = amplitude * np.exp(2j * np.pi * rng.random(len(frequency)))
        error = (basis @ (line * frequency**2)).real
        ratios.append(np.mean(error**2) / np.var((basis @ line).real))
    found = float(expected_ratio(shape, weight[None], frequency)[0])
    margin = 4.0 * np.std(ratios) / np.sqrt(count)
    assert abs(found - np.mean(ratios)) < margin
    share = shape.density(frequency) / np.sum(shape.density(frequency))
    assert abs(np.sum(share * weight) - np.mean(ratios)) > margin
    assert expected_ratio(shape, np.ones((1, len(frequency))), frequency) == pytest.approx(1.0)


@pytest.mark.parametrize("normalise", ["rms", "peak"])
@pytest.mark.parametrize("tuning", ["paper", "matched"])
def test_records_scatter_around_the_expectation(
    tuning: str, normalise: str, tmp_path: Path
) -> None:
    common = [
        *SMALL, f"tuning={tuning}", f"normalise={normalise}", f"results={tmp_path}",
        "record.duration=100", "grid.replicates=32", "grid.natural_period=[3.5,7]",
    ]  # fmt: skip
    keys = ["scheme", "natural_period", "amplitude", "measure", "window"]
    records = owtsweep.run(common).summary()
    found = owtsweep.run([*common, "engine=expected"]).summary()
    both = records.merge(found, on=keys, suffixes=("", "_expected"))
    assert len(both) == len(found) == 4 * 2 * 3 * 6 * 2
    quantile = student.ppf(1.0 - 1e-5, 31) / student.ppf(0.975, 31)
    margin = quantile * (both["ci_high"] - both["mean"]) + 0.02 * both["mean"]
    assert ((both["mean_expected"] - both["mean"]).abs() < margin).all()
    # the x, y and position of one cell add up
    wide = found.pivot(index=[*keys[:3], "window"], columns="measure", values="mean")
    np.testing.assert_allclose(wide["x"] + wide["y"], wide["position"], rtol=1e-12)


@pytest.mark.parametrize("steps", [1200, 38400])
def test_displacements_of_peak_factors_are_those_of_records(steps: int) -> None:
    source, step = SpectralSource(translated(4.0, 2.4e-4), (0.05, 0.6)), 2000.0 / 38400

    def phases(_: str) -> np.random.Generator:
        return stream(3, "hub", (0.0,), 5, known_motion.STREAM)

    position = source.draw_displacement(phases(""), steps, step)
    scaled = source.realise(phases, steps=steps, step=step).position
    assert np.array_equal(position * (1.0 / np.max(np.abs(position))), scaled)


def test_a_peak_factor_is_that_of_records() -> None:
    config = configure("record.duration=200")
    source = SpectralSource(translated(5.0, config.spectrum.bandwidth), (0.05, 0.6))
    rng = np.random.default_rng(3)
    some = [
        np.var(source.realise(lambda _: rng, steps=4000, step=0.05).position) for _ in range(300)
    ]
    (found,) = peak_factors(config, [5.0])
    assert found == pytest.approx(np.mean(some), rel=0.05)
    assert list(cache.folder().glob("*.npz"))


def test_periods_do_not_depend_on_each_other() -> None:
    config = configure("schemes=[MKF]")
    alone = engine.rows(config, "MKF", [4.0])
    among = engine.rows(config, "MKF", [3.3, 4.0, 7.1])
    among = among[among["natural_period"] == 4.0].reset_index(drop=True)
    assert alone.equals(among)


def test_cached_numbers_are_the_same_and_damage_is_noticed() -> None:
    calls = []

    def compute() -> dict[str, np.ndarray]:
        calls.append(1)
        return {"a": np.array([1.0, 2.0])}

    for _ in range(2):
        assert list(cache.cached({"x": 1}, compute)["a"]) == [1.0, 2.0]
    cache.KEPT.clear()
    cache.cached({"x": 1}, compute)
    assert len(calls) == 1
    (file,) = cache.folder().glob("*.npz")
    data = bytearray(file.read_bytes())
    data[-20] ^= 1
    file.write_bytes(data)
    cache.KEPT.clear()
    cache.cached({"x": 1}, compute)
    cache.cached({"x": 2}, compute)
    assert len(calls) == 3


def test_the_verdict_by_brute_force() -> None:
    rng = np.random.default_rng(8)
    values = rng.uniform(1.0, 2.0, (4, 5, 6))
    values[1] = values[0] * (1.0 + 1e-13)  # coinciding: the last name counts
    values[3, 0, 0] = values[2, 0, 0] * (1 + 1e-5)
    values[[0, 1], 0, 0] = 5.0
    verdict = answers.judge(values)
    distinguishable = verdict.difference > answers.RESOLUTION * verdict.mse_best
    for cell in np.ndindex(5, 6):
        column = values[(slice(None), *cell)]
        order = [1, 2, 3]
        order.sort(key=lambda i: column[i])
        assert (verdict.best[cell], verdict.runner_up[cell]) == (order[0], order[1])
        gap = column[order[1]] / column[order[0]] - 1.0
        assert distinguishable[cell] == (gap > answers.RESOLUTION)
    assert not distinguishable[0, 0]
    same = answers.judge(np.ones((2, 1, 1)))
    assert (same.best[0, 0], same.runner_up[0, 0], same.difference[0, 0]) == (1, 0, 0.0)
    assert answers.judge(np.ones((1, 1, 1))).runner_up[0, 0] == -1


def test_tables_keep_their_columns(tmp_path: Path) -> None:
    common = [*SMALL, "tuning=matched", f"results={tmp_path}", "grid.replicates=2"]
    records, found = owtsweep.run(common), owtsweep.run([*common, "engine=expected"])
    for name in ("summary", "best_scheme"):
        one, other = records.table(name), found.table(name)
        assert list(one.columns) == list(other.columns)
        keys = list(one.columns[: 4 if name == "best_scheme" else 5])
        mine = one if name == "best_scheme" else one[~one["measure"].isin(["nees", "nis"])]
        assert mine[keys].reset_index(drop=True).equals(other[keys])
    summary = found.summary()
    assert (summary["n"] == 0).all()
    assert summary["ci_low"].isna().all()
    assert not (found.best_scheme()["best"] == "EKF").any()  # it coincides with MKF
    engine = HubStudy().engine(found.config)
    assert {block.content["scheme"] for block in engine.plan(found.config)} == set(SCHEMES)
    figures = found.draw(engine.overview(found.config))
    assert [file.suffix for file in figures] == [".png", ".svg"]
    with pytest.raises(InputError, match=r"^only: this run has no figure 'figure_03"):
        found.draw("figure_03_record")


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["evaluation=direct"], r"^evaluation: engine=expected runs no record"),
        (["measures.extremes=true"], r"^measures.extremes: largest errors need records"),
    ],
)
def test_refusals(overrides: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        configure("engine=expected", *overrides)


def test_a_scheme_without_kernel_is_refused() -> None:
    entry = "{_target_:hold_last_fix.HoldLastFix}"
    with pytest.raises(InputError, match=r"^schemes: HoldLastFix has no kernel"):
        owtsweep.run([*SMALL, "engine=expected", f"schemes=[MKF,{entry}]"])


def test_a_users_scheme_that_is_told_the_motion_is_not_taken_for_skf() -> None:
    entry = "{_target_: user_schemes.Told}"
    with pytest.raises(InputError, match=r"^schemes: hold has no kernel"):
        configure("engine=expected", "measures.window=settled", f"schemes=[{entry}]")
