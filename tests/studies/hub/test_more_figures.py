"""Records, time histories, error spectra and the two maps: what they show is what was computed."""

from __future__ import annotations

import dataclasses
import logging
from pathlib import Path

import numpy as np
import pytest
from tools import SMALL, assert_same, configure, filtered_states, measured, ned

import owtsweep
from experiments.ren2019 import two_maps
from owtsweep.config import changed
from owtsweep.errors import InputError
from owtsweep.estimation.discretisation import predict
from owtsweep.figures import style
from owtsweep.figures.lines import decimate
from owtsweep.studies.hub import batch, estimates
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.figures import error_spectra, time_histories
from owtsweep.studies.hub.histories import Histories, natural_period_of, simulate_histories
from owtsweep.sweep.runs import Run

pytestmark = pytest.mark.usefixtures("kernels")

#: The numbers below hold for these sensors, whatever a tuning says.
SENSORS = (
    "sensors.gnss.sigma=0.03",
    "sensors.imu.sigma=0.15",
    "sensors.imu.bias_initial=0.05",
    "sensors.imu.bias_walk=0.001",
)
TINY = [
    *SMALL,
    "record.duration=60",
    "grid.natural_period=[4.0,6.0]",
    "grid.amplitude=[0.05,1.0,10.0]",
    "grid.replicates=2",
]


def texts(figure) -> str:
    found = figure.findobj(lambda artist: hasattr(artist, "get_text"))
    return " ".join(" ".join(artist.get_text() for artist in found).split())


@pytest.fixture(scope="module")
def runs(kernels, tmp_path_factory) -> dict[str, Run]:
    folder = tmp_path_factory.mktemp("results")
    return {
        tuning: owtsweep.run([*TINY, f"tuning={tuning}", f"name={tuning}", f"results={folder}"])
        for tuning in ("paper", "matched")
    }


@pytest.fixture(scope="module")
def record(kernels) -> Histories:
    level = ("sensors.yaw=0", "sensors.gravity=[0,0]", "sensors.gnss.delay=0.2")
    windows = ("hme.smoother_window=5", "hme.mhe.smoother_window=5")
    changes = ("record.duration=150", *SENSORS, *level, *windows)
    return simulate_histories(configure(*changes, tuning="matched"))


@pytest.mark.parametrize("n", [3999, 4000, 4001, 10_007, 200_000])
def test_decimation_keeps_extremes_and_order(n: int) -> None:
    rng = np.random.default_rng(n)
    time = np.sort(rng.random(n))
    values = rng.normal(size=n)
    values[rng.integers(n)] = 50.0
    t, kept = decimate(time, values)
    assert len(kept) <= max(4002, min(n, 4000))
    assert (kept.min(), kept.max()) == (values.min(), values.max())
    assert np.all(np.diff(t) > 0)
    assert (t[0], t[-1]) == (time[0], time[-1])
    for start, end in zip(np.arange(0, 1, 0.1), np.arange(0.1, 1.1, 0.1), strict=True):
        # a span may end across the border, so compare just within
        inside, whole = (time > start) & (time < end), (t >= start) & (t <= end)
        assert kept[whole].max() >= np.sort(values[inside])[-3:].min()
        assert kept[whole].min() <= np.sort(values[inside])[:3].max()


@pytest.mark.parametrize("tuning", ["paper", "matched"])
@pytest.mark.parametrize("name", ["MKF", "HME1", "HME2"])
def test_states_are_what_the_estimates_come_from(name: str, tuning: str) -> None:
    config = configure(tuning=tuning)
    data, sensors = measured(config)
    force, fixes = ned(data, sensors)
    chain = resolve(name).kernel(Known(sensors, config))
    states = estimates.states(chain, force, fixes)
    position, velocity, _ = estimates.trajectories(chain, force, fixes)
    if chain.filter.window == 0:
        expected = filtered_states(chain, force, fixes).reshape(states.shape)
        assert_same(states.reshape(len(force), -1), expected.reshape(len(force), -1), "", 1e-12)
        return
    ahead = chain.predictor.steps
    # steps around the border between two chunks among them
    for k in [ahead, 100, *range(batch.CHUNK - 3, batch.CHUNK + 9), len(force) - 1]:
        for axis in range(2):
            start = states[k, [0, 1, 3], axis]
            now = predict(chain.input_model, start, force[k - ahead : k, [axis]])
            assert now[0] == pytest.approx(position[k, axis], abs=1e-10)
            assert now[1] == pytest.approx(velocity[k, axis], abs=1e-10)


def test_the_integrated_imu_drifts_with_its_bias(record: Histories) -> None:
    t = record.time[-1]
    drift = record.integrated["position"][-1] - record.truth["position"][-1]
    bias = record.truth["bias"].mean(axis=0)
    assert np.all(np.abs(drift) > 20 * np.abs(record.truth["position"]).max())
    np.testing.assert_allclose(drift, 0.5 * bias * t**2, rtol=0.2)
    np.testing.assert_allclose(
        record.integrated["velocity"][-1] - record.truth["velocity"][-1], bias * t, rtol=0.2
    )
    first = slice(0, 20)  # one second after the start nothing has drifted yet
    assert (
        np.abs(record.integrated["position"][first] - record.truth["position"][first]).max() < 0.1
    )


def test_histories_hold_truth_measurements_and_estimates(record: Histories) -> None:
    assert record.natural_period == 3.8
    along = record.truth["position"] @ [np.cos(np.pi / 6), np.sin(np.pi / 6)]
    assert np.max(np.abs(along)) == pytest.approx(record.amplitude)
    # what the IMU reports is acceleration and bias, and white noise of known size
    rest = record.measured - record.truth["acceleration"] - record.truth["bias"]
    assert rest.std() == pytest.approx(0.15, rel=0.1)
    M, delay = 10, round(record.delay * 20)
    lag = record.fixes[1:] - record.truth["position"][M - delay :: M][: len(record.fixes) - 1]
    assert lag.std() == pytest.approx(0.03, rel=0.15)
    for name in ("MKF", "HME1", "HME2"):
        found = record.estimated[name]
        assert found.lag == (0 if name == "MKF" else delay + 5)
        settled = len(record.time) // 2
        n = len(record.time) - found.lag
        for quantity, limit in (("acceleration", 0.15), ("bias", 0.03)):
            error = found.values[quantity] - record.truth[quantity][:n]
            assert np.sqrt(np.mean(error[settled:] ** 2)) < limit, (name, quantity)
        assert (
            np.sqrt(np.mean((found.values["position"] - record.truth["position"])[settled:] ** 2))
            < 0.15
        )


def test_the_lagged_acceleration_stands_at_its_own_moment(record: Histories) -> None:
    """Shifted by its lag the smoothed acceleration fits better than where it becomes known."""
    found = record.estimated["HME1"]
    late, n = found.values["acceleration"], len(record.time) - found.lag
    as_drawn = np.mean((late - record.truth["acceleration"][:n])[400:] ** 2)
    as_known = np.mean((late - record.truth["acceleration"][found.lag :])[400:] ** 2)
    assert as_drawn < 0.5 * as_known


def test_bias_and_gravity_and_yaw_are_told_apart() -> None:
    config = configure(
        "record.duration=100", "schemes=[MKF]", *SENSORS, tuning="matched"
    )  # yaw 37°, gravity
    turned = simulate_histories(config)
    error = turned.estimated["MKF"].values["bias"] - turned.truth["bias"]
    assert np.abs(error[1000:]).mean() < 0.03
    drift = turned.integrated["position"][-1] - turned.truth["position"][-1]
    mean_bias = turned.truth["bias"].mean(axis=0)
    np.testing.assert_allclose(drift, 0.5 * mean_bias * turned.time[-1] ** 2, rtol=0.3)


@pytest.mark.parametrize(
    ("quantity", "zoom"),
    [("position", False), ("velocity", True), ("acceleration", True), ("bias", False)],
)
def test_time_histories(record: Histories, quantity: str, zoom: bool) -> None:
    figure = time_histories.draw(record, quantity, zoom=zoom, tuning="paper")
    shown = texts(figure)
    for part in ("natural period 3.8 s", "amplitude 0.5 m", "tuning: paper", "HME2", "is our"):
        assert part in shown
    part = {"position": "0 to 120 s", "velocity": "105 to 120 s", "acceleration": "114 to 120 s"}
    if quantity == "bias":
        assert "Accelerometer bias estimate natural period" in shown  # the whole record
        assert "before, lines may leave them" in shown
    else:
        assert f"estimate, {part[quantity]} of 150 s natural period" in shown
    assert ("Not shown: IMU alone" in shown) == (quantity == "velocity")
    assert "Not drawn, as in the paper: EKF." in shown
    last = figure.axes[2]
    lines = [line for line in last.get_lines() if len(line.get_xdata()) > 2]
    assert len(lines) == 3
    if not zoom:
        found = record.estimated["HME2"]
        n = len(record.time) - (found.lag if quantity == "bias" else 0)
        error = found.values[quantity] - record.truth[quantity][:n]
        total = np.abs(error).sum() * record.time[1]
        assert lines[-1].get_ydata()[-1] == pytest.approx(total)
        assert f"HME2 {total:.3g}" in shown
    if quantity == "acceleration":
        assert "HME1 and HME2 0.45 s later" in shown


def test_time_histories_refuse_what_is_not_there(record: Histories) -> None:
    none = dataclasses.replace(record.estimated["MKF"], values={})
    without = dataclasses.replace(record, estimated={"MKF": none})
    with pytest.raises(InputError, match=r"^schemes: none of this run estimates the acceleration"):
        time_histories.draw(without, "acceleration", tuning="paper")


def test_sigma_2_has_no_acceleration() -> None:
    found = simulate_histories(configure("record.duration=10", "mkf.model=sigma2", "schemes=[MKF]"))
    assert list(found.estimated) == ["MKF"]
    assert "acceleration" not in found.estimated["MKF"].values


def test_a_printed_spectrum_takes_the_nearest_period_of_its_grid() -> None:
    config = configure("spectrum.kind=printed", "grid.natural_period=[8.0,6.0]")
    assert natural_period_of(config) == 6.0
    assert natural_period_of(configure()) == 3.8


def test_a_run_draws_its_records_histories_and_spectra(runs: dict[str, Run]) -> None:
    with pytest.raises(InputError) as refused:
        runs["paper"].draw("figure_19")
    for number in ("03_record", "04_spectrum", "09_pos", "10_position_", "11", "12", "13", "14"):
        assert f" figure_{number}" in str(refused.value)
    assert "error_spectra" in str(refused.value)
    files = runs["paper"].draw("figure_04_spectrum")
    assert [file.name for file in files] == ["figure_04_spectrum.png", "figure_04_spectrum.svg"]
    assert all(0 < file.stat().st_size < style.SVG_LIMIT for file in files)


def test_a_long_history_stays_a_small_file(tmp_path: Path) -> None:
    changes = ["record.duration=600", "sensors.imu.rate=100", "schemes=[MKF,HME1,HME2]"]
    long = simulate_histories(configure(*changes, tuning="matched"))
    figure = time_histories.draw(long, "bias", tuning="paper")
    svg = tmp_path / "bias.svg"
    with style.context():
        figure.savefig(svg)
    assert svg.stat().st_size < style.SVG_LIMIT


def test_a_figure_that_a_run_cannot_have_is_left_out(
    runs: dict[str, Run], monkeypatch, caplog, tmp_path: Path
) -> None:
    def refuse(*_args: object, **_kwargs: object) -> None:
        raise InputError("schemes: none")

    monkeypatch.setattr(error_spectra, "draw", refuse)
    monkeypatch.setattr(style, "save", lambda *_: [])
    with caplog.at_level(logging.WARNING):
        runs["paper"].draw()
    assert "error_spectra is left out: schemes: none" in caplog.text
    with pytest.raises(InputError, match=r"^schemes: none$"):
        runs["paper"].draw("error_spectra")


def test_error_spectra_show_curves_and_floors(runs: dict[str, Run]) -> None:
    config = runs["matched"].config
    assert isinstance(config, HubConfig)
    errors = error_spectra.compute(config, points=8)
    assert list(errors) == ["EKF", "MKF", "HME1", "HME2"]
    bare = {**errors, "HME1": dataclasses.replace(errors["HME1"], floor=None)}
    figure = error_spectra.draw(config, errors={k: bare[k] for k in ("MKF", "HME1")})
    shown = texts(figure)
    assert "matched: no bar (the noise does not settle) for HME1." in shown
    assert (
        "no curve (no kernel whose gains serve all motions, or it does not settle) for EKF, HME2."
        in shown
    )
    axes = figure.axes[0]
    drawn = {line.get_label(): line for line in axes.get_lines()}
    assert list(drawn["MKF"].get_ydata()) == list(errors["MKF"].spectrum.position)
    heights = [line.get_ydata()[0] for line in axes.get_lines() if len(line.get_ydata()) == 2]
    assert errors["MKF"].floor is not None
    assert errors["MKF"].floor.of("position") in heights
    with pytest.raises(InputError, match=r"^schemes: none of this run has a settled"):
        error_spectra.draw(config, errors={})


def test_two_maps_show_both_runs(runs: dict[str, Run], monkeypatch, tmp_path: Path) -> None:
    compute = error_spectra.compute
    monkeypatch.setattr(error_spectra, "compute", lambda config: compute(config, points=6))
    figure = two_maps.draw(runs["paper"], runs["matched"])
    shown = texts(figure)
    for part in ("tuning: paper", "tuning: matched", "2 records per cell", "bootstrap"):
        assert part in shown
    assert "EKF and MKF coincide, shown as MKF" in shown
    left, right = figure.axes[2], figure.axes[3]
    assert left.get_ylim() == right.get_ylim()
    with style.context():
        figure.savefig(tmp_path / "two.svg")
    assert (tmp_path / "two.svg").stat().st_size < style.SVG_LIMIT


def test_two_maps_say_what_else_differs() -> None:
    one = configure(*SENSORS)
    other = changed(configure(*SENSORS, "sensors.yaw=1"), seed=7)
    assert two_maps._differences([one, one]) == []
    assert two_maps._differences([one, other]) == [
        "The two runs differ not only in their tuning: seed, sensors."
    ]
