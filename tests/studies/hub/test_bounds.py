"""The bounds of the mean square error: two ways to one number, limits, and known numbers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from tools import SMALL

import owtsweep
from experiments.better import bound_on_window, roll_off
from owtsweep import InputError
from owtsweep.config import with_values
from owtsweep.motion.shaping import fit_shaping_filter
from owtsweep.studies import compose
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.bounds.cells import (
    BOUNDED,
    add_efficiency,
    compute_bounds,
    find_bounds,
    find_shape,
)
from owtsweep.studies.hub.bounds.kalman import kalman_bounds
from owtsweep.studies.hub.bounds.known_spectrum import bound_of_known_spectrum
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.figures import efficiency
from owtsweep.studies.hub.known_motion import KnownMotion, find_known_motion
from owtsweep.studies.hub.sensors import Sensors


@pytest.fixture(scope="module")
def config() -> HubConfig:
    return compose(["sensors=strong_bias", "record.duration=200"])  # type: ignore[return-value]


@pytest.fixture(scope="module")
def slow(config: HubConfig) -> Sensors:
    """The sensors with ten samples of the IMU averaged to one: a window of few samples."""
    sensors = sensing.sensors(config.sensors)
    sigma = sensors.force_sigma / np.sqrt(10.0)
    return replace(sensors, step=0.1, fix_interval=10, delay=2, force_sigma=sigma)


@pytest.mark.parametrize(
    ("delay", "interval", "tilt"), [(0, 10, 0.0), (2, 10, 0.02), (9, 10, 0.0), (7, 5, 0.0)]
)
def test_a_window_and_a_recursion_agree(
    slow: Sensors, delay: int, interval: int, tilt: float
) -> None:
    frequency = (np.arange(1500) + 0.5) * 2e-3
    resonance = frequency**2 / ((frequency**2 - 0.0625) ** 2 + (0.06 * frequency) ** 2) ** 3
    shape = fit_shaping_filter(frequency, resonance, 6, 1e-6)
    known = KnownMotion(frequency, shape.density(frequency), np.ones(2))
    sensors = replace(slow, delay=delay, fix_interval=interval, tilt=tilt)
    for variance in (1e-4, 0.1):
        recursion = bound_of_known_spectrum(shape, variance, sensors)
        window = bound_on_window(known, variance, sensors, 40.0)
        assert recursion == pytest.approx(window, rel=3e-3)


def test_the_spectrum_of_the_study_is_fitted_to_a_per_cent(
    config: HubConfig, slow: Sensors
) -> None:
    known = find_known_motion(config, 4.0, 1.0)
    shape = find_shape(config, known)
    for amplitude in (0.2, 10.0):
        variance = amplitude**2 * known.variance[0]
        recursion = bound_of_known_spectrum(shape, variance, slow)
        assert recursion == pytest.approx(bound_on_window(known, variance, slow, 50.0), rel=0.01)


def test_the_bounds_of_some_cells_are_known(config: HubConfig) -> None:
    """A calculation apart from this program, with a largest displacement of 3.5 times the rms."""
    same_crest = with_values(config, {"normalise": "rms"})
    for amplitude, position in ((0.05, 5.3e-5), (0.2, 2.5e-4), (1.0, 1.2e-3), (10.0, 2.5e-3)):
        bound = find_bounds(same_crest, 4.0, amplitude / 3.5)["position"]
        assert bound == pytest.approx(position, rel=0.07)


def test_the_bound_lies_below_what_knowing_less_gives(config: HubConfig) -> None:
    nothing = kalman_bounds(config)
    for amplitude in (0.01, 1.0, 20.0):
        known = find_known_motion(config, 4.0, amplitude)
        bound = find_bounds(config, 4.0, amplitude)
        direction = find_with_direction(config, known)
        assert 0.0 < direction["position"] < bound["position"] < nothing["position"]
        assert 0.0 < direction["velocity"] < bound["velocity"] < nothing["velocity"]
        assert bound["position"] < known.variance.sum()
    assert bound["position"] == pytest.approx(nothing["position"], rel=0.02)
    assert direction["position"] == pytest.approx(0.5 * nothing["position"], rel=0.02)
    northwards = with_values(config, {"wave_direction": 0.0})
    known = find_known_motion(northwards, 4.0, 1.0)
    assert find_bounds(northwards, 4.0, 1.0) == find_with_direction(northwards, known)


def find_with_direction(config: HubConfig, known: KnownMotion) -> dict[str, float]:
    """The bounds if the direction of the motion is known too: there is no error across."""
    told = find_shape(config, known), known.variance.sum(), sensing.sensors(config.sensors)
    return dict(zip(BOUNDED, bound_of_known_spectrum(*told), strict=True))


def test_a_spectrum_that_rolls_off_is_harder_to_follow(config: HubConfig) -> None:
    known, sensors = find_known_motion(config, 4.0, 0.2), sensing.sensors(config.sensors)
    edges, tail = (
        sum(bound_of_known_spectrum(find_shape(config, each), v, sensors)[0] for v in each.variance)
        for each in (known, roll_off(config, 4.0, known))
    )
    assert 1.2 < tail / edges < 2.0


def test_an_ac_coupled_imu_has_no_bound() -> None:
    with pytest.raises(InputError, match=r"imu.high_pass: the bound .*=null"):
        find_bounds(compose(["sensors.imu.high_pass=0.001"]), 4.0, 1.0)  # type: ignore[arg-type]


def test_efficiency_stands_in_the_summary_of_settled_errors(config: HubConfig) -> None:
    small = with_values(config, {"grid.natural_period": [4.0], "grid.amplitude": [0.1, 1.0]})
    bounds = compute_bounds(small)
    summary = pd.DataFrame(
        [
            ("EKF", 4.0, 1.0, "position", "full", 0.01),
            ("EKF", 4.0, 1.0, "position", "settled", 0.01),
            ("EKF", 4.0, 0.1, "velocity", "settled", 0.02),
            ("EKF", 4.0, 0.1, "vx", "settled", 0.02),
        ],
        columns=["scheme", "natural_period", "amplitude", "measure", "window", "mean"],
    )
    table = add_efficiency(summary, small)
    assert list(table.columns) == [*summary.columns, "efficiency_a", "efficiency_b"]
    cells = bounds.set_index(["amplitude", "measure"])
    for letter in "ab":
        bound = cells[f"bound_{letter}"]
        wanted = [
            np.nan, bound[1.0, "position"] / 0.01, bound[0.1, "velocity"] / 0.02, np.nan
        ]  # fmt: skip
        assert table[f"efficiency_{letter}"].to_numpy() == pytest.approx(wanted, nan_ok=True)


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize("engine", ["batch", "expected"])
def test_a_run_on_request_has_efficiencies(tmp_path: Path, engine: str) -> None:
    words = [
        *SMALL,
        "schemes=[EKF]",
        "grid.amplitude=[0.7]",
        f"engine={engine}",
        f"results={tmp_path}",
    ]
    run = owtsweep.run([*words, "measures.efficiency=true"])
    summary = run.summary()
    settled = summary[(summary["window"] == "settled") & (summary["measure"] == "position")]
    assert np.all(settled["efficiency_b"] < settled["efficiency_a"])
    assert np.all(settled["efficiency_b"] < 1.0)
    assert "efficiency_a" not in owtsweep.run(words).summary()


def test_efficiency_needs_a_spectrum() -> None:
    with pytest.raises(InputError, match=r"measures.efficiency .* leave out motion=plant"):
        compose(["motion=plant", "measures.efficiency=true"])


def test_the_figure_shows_the_efficiencies_of_the_table(config: HubConfig) -> None:
    small = with_values(config, {"grid.natural_period": [4.0, 6.0], "grid.amplitude": [0.1, 1.0]})
    cells = [(4.0, 0.1, 0.034), (4.0, 1.0, 0.97), (6.0, 0.1, 0.002), (6.0, 1.0, 1.04)]
    rows = [("MKF", *cell[:2], "position", "settled", cell[2]) for cell in cells]
    other = [
        ("MKF", 4.0, 0.1, "velocity", "settled", 0.5),
        ("MKF", 4.0, 0.1, "position", "full", np.nan),
    ]
    names = ["scheme", "natural_period", "amplitude", "measure", "window", "efficiency_b"]
    figure = efficiency.draw(small, pd.DataFrame([*rows, *other], columns=names))
    panel, _ = figure.axes  # one scheme has results; the other axes are the colours' legend
    shown = {(*text.get_position(), text.get_text()) for text in panel.texts}
    assert shown == {(0, 0, "3.4"), (0, 1, "97"), (1, 0, "<1"), (1, 1, "104")}
    assert panel.get_title(loc="left") == "MKF"
    darkness = [1.0 - np.mean(patch.get_facecolor()[:3]) for patch in panel.patches]
    assert np.argsort(darkness).tolist() == [2, 0, 1, 3]
