"""In a world that departs, truth and measurements depart, and what schemes are told does not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_tower import SMALL_TOWER
from tools import from_mapping, lay_over

import owtsweep
from owtsweep.cli.program import main
from owtsweep.config import as_mapping, with_values
from owtsweep.config.over import NOMINAL
from owtsweep.errors import InputError
from owtsweep.studies import compose, get_study
from owtsweep.studies.base.axes import Departure, Untold
from owtsweep.studies.base.blocks import Records, find_worlds
from owtsweep.studies.base.declaration import AnyDeclaration
from owtsweep.studies.base.schemes import identify

SHORT = {
    "hub": [
        "record.duration=400", "grid.natural_period=[5]", "grid.amplitude=[0.5]",
        "evaluation=direct",
    ],
    "floater": [
        "record.duration=60", "record.rate=10", "record.settling=20", "plane=snr_loss",
        "grid.snr=[20]", "grid.loss=[0]",
    ],
    "blade": [
        "record.duration=200", "record.settling=20", "grid.sigma=[0.006]", "grid.outage=[0]",
    ],
    # Long enough for a few outages.
    "tower": [
        *SMALL_TOWER, "record.duration=60", "record.rate=100", "grid.noise=[1]",
        "grid.soil_factor=[1]",
    ],
}  # fmt: skip
#: Another value of each key of the truth, or what the key needs besides.
CHANGED: dict[str, dict[str, object]] = {
    "sensors.gnss.sigma": {"sensors.gnss.sigma": 0.09},
    "sensors.gnss.delay": {"sensors.gnss.delay": 0.5},
    "sensors.gnss.scale": {"sensors.gnss.scale": 1.1},
    "sensors.gnss.outliers": {"sensors.gnss.outliers.rate": 0.3},
    "sensors.gnss.loss": {"sensors.gnss.loss.probability": 0.3},
    "sensors.gnss.correlation": {"sensors.gnss.correlation.sigma": 0.1},
    "sensors.imu.sigma": {"sensors.imu.sigma": 0.3},
    "sensors.imu.bias_initial": {"sensors.imu.bias_initial": 0.3},
    "sensors.imu.bias_walk": {"sensors.imu.bias_walk": 0.01},
    "sensors.imu.tilt": {"sensors.imu.tilt": 0.02},
    "sensors.imu.high_pass": {"sensors.imu.high_pass": 0.01},
    "spectrum.bandwidth": {"spectrum.bandwidth": 1e-3},
    "motion.peaks": {"motion.peaks": [0.1]},
    "motion.pace": {"motion.pace": [[0.0, 1.1]]},
    "motion.envelope": {"motion.envelope": [[0.0, 1.0], [30.0, 3.0]]},
    "faults.bias": {"faults.bias": 0.2},
    "faults.drift": {"faults.drift": 0.2},
    "faults.loss": {"faults.loss": 0.01},
    "faults.loss_length": {"faults.loss": 0.01, "faults.loss_length": 10},
    "grid.delay": {"grid.delay": [2]},
    "grid.bias": {"grid.bias": [0.5]},
    "sensors.bias_drift": {"sensors.bias_drift": 0.5},
    "sensors.process_snr": {"sensors.process_snr": 20.0},
    "sensors.loss_every": {"sensors.loss_every": 5.0},
    "sensors.loss_length": {"sensors.loss_every": 5.0, "sensors.loss_length": 2.0},
    "sensors.jitter": {"sensors.jitter": 0.5},
    "grid.offset": {"grid.offset": [0.1]},
    "grid.lever": {"grid.lever": [0.1]},
    "grid.period": {"grid.period": [15.0]},
    "grid.amplitude": {"grid.amplitude": [0.5]},
    "grid.heading": {"grid.heading": [2.0]},
    "motion.freedoms": {"motion.freedoms.v.sigma": 0.2},
    "motion.gust_time": {"motion.gust_time": 5.0},
    "motion.bending": {"motion.bending.sag": 0.3},
    "motion.tugger": {"motion.tugger.heading": 2.0},
    "unit.force_sigma": {"unit.force_sigma": 0.1},
    "unit.force_bias": {"unit.force_bias": 0.1},
    "unit.force_walk": {"unit.force_walk": 0.1},
    "unit.rate_sigma": {"unit.rate_sigma": 0.5},
    "unit.rate_bias": {"unit.rate_bias": 0.5},
    "unit.rate_walk": {"unit.rate_walk": 0.5},
    "sensors.receiver": {"sensors.receiver.red_sigma": 0.1},
    "sensors.prism_sigma": {"sensors.prism_sigma": 0.1},
    "sensors.prism_offset": {"sensors.prism_offset": 0.2},
    "sensors.stretch": {"sensors.stretch": 0.2},
}


def make(study: str, *words: str) -> tuple[AnyDeclaration, Any]:
    config: Any = compose([f"study={study}", *SHORT[study], "grid.replicates=1", *words])
    if study == "hub":
        from owtsweep.studies.hub.engines import find_declaration

        return find_declaration(config), config
    return get_study(study).declaration(), config  # type: ignore[attr-defined]


def take(declaration: AnyDeclaration, config: Any, world: Any) -> tuple[list[Any], list[Any]]:
    """Return what schemes are told of a record in a world, and what is measured."""
    (cell,) = declaration.axes.list_cells(config)
    ((_, parts),) = Records(declaration, config, [0], world).take(config, cell)
    return [p.known for p in parts.values()], [identify(p.measured) for p in parts.values()]


def same_but_start(known: Any) -> Any:
    """Leave out the start of a record, which is measured: of the blade and the floater."""
    if not hasattr(known, "start"):
        return identify(known)
    from dataclasses import replace

    return identify(replace(known, start=None))


@pytest.mark.parametrize("study", SHORT)
def test_in_each_world_of_a_study_sensors_say_otherwise_and_schemes_are_told_the_same(
    study: str,
) -> None:
    declaration, config = make(study)
    names = [NOMINAL, *declaration.list_untold(config).departures]
    declaration, config = make(study, f"over={{world: [{','.join(names)}]}}")
    worlds = find_worlds(declaration, config)
    assert list(worlds) == names
    told, measured = take(declaration, config, worlds.pop(NOMINAL))
    for world in worlds.values():
        known, other = take(declaration, config, world)
        assert list(map(same_but_start, known)) == list(map(same_but_start, told))
        assert other != measured


@pytest.mark.parametrize("study", SHORT)
def test_each_key_of_the_truth_changes_what_is_measured_and_nothing_that_is_told(
    study: str,
) -> None:
    declaration, config = make(study)
    told, measured = take(declaration, config, None)
    from owtsweep.studies.base.axes import World

    for key in declaration.list_untold(config).keys:
        values = CHANGED.get(key)
        if values is None:  # an axis of this map
            assert key.removeprefix("grid.") in declaration.axes.find_axes(config)
            continue
        moved = {k.removeprefix("grid."): v[0] for k, v in values.items()
                 if k.startswith("grid.") and isinstance(v, list)}  # fmt: skip
        world = World(with_values(config, values), moved)
        known, other = take(declaration, config, world)
        assert list(map(same_but_start, known)) == list(map(same_but_start, told)), key
        assert other != measured, key


def test_an_axis_off_the_map_may_be_what_nobody_knows() -> None:
    declaration, config = make("floater", "over={delay: [0, 3]}")
    worlds = find_worlds(declaration, config)
    assert worlds["delay=3"].moved == {"delay": 3.0}
    keys = [block.content for block in _plan(config)]
    assert [each.get("truth") for each in keys[:: len(keys) // 2]] == [None, {"delay": 3.0}]


def _plan(config: Any) -> list[Any]:
    from owtsweep.sweep.plan import make_plan

    return list(make_plan(get_study(config.study), config).values())


@pytest.mark.parametrize(
    ("study", "over", "line"),
    [
        ("hub", "{natural_period: [3]}", "over.natural_period: this is an axis of the map"),
        ("hub", "{grid.amplitude: [3]}", "over.grid.amplitude: this is an axis of the map"),
        ("floater", "{snr: [3]}", "over.snr: this is an axis of the map"),
        ("floater", "{believed: [3]}", "over.believed: it does not change the truth alone"),
        ("hub", "{world: [late]}", "over.world: there is no world 'late' here; did you mean"),
        ("tower", "{world: [two_peaks]}", "over.world: there is no world 'two_peaks' here"),
        ("hub", "{mkf.q_a: [1]}", "over.mkf.q_a: it does not change the truth alone"),
        ("hub", "{sensors.gnss.rate: [2]}", "over.sensors.gnss.rate: it does not change"),
        ("hub", "{seed: [2]}", "over.seed: it does not change the truth alone"),
        ("hub", "{sensors.gnss.sigma: [-1]}", "over: sensors.gnss.sigma: -1 m must be"),
        ("hub", "{sensors.gnss.delay: [0.123]}", "over: in the world sensors.gnss.delay=0.123, "),
        ("hub", "{sensors.gnss.fog: [1]}", "over.sensors.gnss.fog: it does not change"),
        ("hub", "{world: [nominal], weights: [1, 2]}", "over.weights: [1, 2] does not fit 1"),
        ("hub", "{world: [nominal, multipath], weights: [1, 0]}", "over.weights: [1, 0] does"),
        ("hub", "{world: [nominal, nominal]}", "over.world: nominal stands there twice"),
        ("hub", "{world: []}", "over.world: it has 0 values; give 1 to 100"),
        ("hub", "{world: [nominal], sensors.gnss.sigma: [1]}", "over: it has 2 axes"),
        ("hub", "{weights: [1]}", "over: it has 0 axes"),
        ("hub", "{world: nominal}", "over.world: 'nominal' is no list; use e.g."),
        ("hub", "nominal", "over: 'nominal' is no mapping of names"),
    ],
)
def test_what_cannot_be_unknown_is_refused_in_one_line(study: str, over: str, line: str) -> None:
    _, config = make(study)
    with pytest.raises(InputError) as caught:
        from_mapping(lay_over(as_mapping(config), [f"over={over}"]))
    assert str(caught.value).startswith(line)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["study=mating"], "over: nothing departs from what schemes are told in the study mating"),
        (["grid.replicates=auto"], "over: a regret is over the same records in each world"),
        (["tuning=[paper,matched]"], "over: a regret is of one tuning"),
        (["engine=expected"], "over: a regret needs records"),
    ],
)
def test_runs_that_cannot_have_a_regret_are_refused(words: list[str], line: str) -> None:
    with pytest.raises(InputError) as caught:
        compose(["grid.replicates=2", "over={world: [nominal, outliers_1]}", *words])
    assert str(caught.value).startswith(line)


def test_rules_of_the_tuning_do_not_follow_a_departure() -> None:
    declaration, config = make("hub", "over={sensors.imu.tilt: [0.02]}")
    given = find_worlds(declaration, config)["sensors.imu.tilt=0.02"].config
    assert (given.sensors.imu.tilt, given.mkf.tilt) == (0.02, 0.0)
    assert np.isfinite(given.mkf.q_a)


def test_another_study_has_regret_in_its_tables_maps_and_answer(tmp_path: Path) -> None:
    run = owtsweep.run([
        "study=floater", f"results={tmp_path}", "record.duration=60", "record.rate=10",
        "record.settling=20", "grid.delay=[0,2]", "grid.bias=[0.1]", "grid.replicates=2",
        "schemes=[KF,KF_DELAY]", "over={world: [nominal,noisy], weights: [3,1]}",
        "compute.backend=threading",
    ])  # fmt: skip
    regret, summary = run.regret(), run.table("regret_summary")
    assert {*regret["world"]} == {"nominal", "noisy"}
    assert regret.groupby(["delay", "bias", "world"])["regret"].min().eq(1.0).all()
    assert summary.groupby(["delay", "bias"])["least_mean"].sum().eq(1).all()
    assert run.table("worlds")["weight"].tolist() == [0.75, 0.25]
    assert [path.suffix for path in run.draw("regret_mean")] == [".png", ".svg"]
    page = run.write_report().read_text()
    assert "If nobody knows the world (over 2 worlds, declared weights)" in page
    assert "twice the noise: 6 dB less" in page


def test_the_command_line_refuses_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", "grid.replicates=2", "over={world: [fog]}"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("owtsweep: over.world: there is no world 'fog' here; ")
    assert line.endswith("plant_seas, drifting_period")


def test_a_world_that_moves_an_axis_of_the_map_is_left_out() -> None:
    departures = {key: Departure("departs", {key: 1.0}) for key in ("grid.delay", "sensors.jitter")}
    untold = Untold(("sensors",), departures)
    assert untold.leave_out(["delay", "snr"]) == Untold(
        ("sensors",), {"sensors.jitter": departures["sensors.jitter"]}
    )
    assert untold.leave_out(["snr"]) == untold
