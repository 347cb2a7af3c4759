"""motion=plant: a structure under waves as the source of motion of the hub study."""

from __future__ import annotations

import logging
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import yaml
from tools import SMALL

import owtsweep
from experiments.ren2019 import fidelity
from experiments.ren2019.histories import measure_histories
from owtsweep import InputError
from owtsweep.cli.program import main
from owtsweep.config import Config, with_values
from owtsweep.gravity import GRAVITY
from owtsweep.studies import compose, get_study
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.engines import find_declaration
from owtsweep.studies.hub.figures import listing, record_and_spectrum
from owtsweep.studies.hub.histories import simulate_histories
from owtsweep.studies.hub.records import Records, make_records_at
from owtsweep.studies.hub.study import HubStudy
from owtsweep.studies.hub.worlds import PLANT, find_world, list_maps
from owtsweep.sweep.keys import run_hash
from owtsweep.sweep.plan import make_plan
from owtsweep.sweep.run import sweep

ROOT = Path(__file__).parents[3]
SEA = {"hs": 2.0, "tp": 6.0, "blades": 0, "friction_angle": "layers"}
CLAMPED = """
name: clamped
source: a test
mudline: -30.0
damping: 0.01
clamped: true
tubes:
  - {name: tube, bottom: -30.0, top: 80.0, diameter: [6, 4], thickness: [.05, .03], density: 7850}
water: {density: 1025.0}
"""


@cache
def _composed() -> Config:
    one_sea = ("motion.hs=[2.0]", "motion.tp=[6.0]")
    return compose([*SMALL, "motion=plant", *one_sea, "schemes=[MKF]"])


def plant(**values: Any) -> HubConfig:
    """A small configuration with motion=plant; `__` stands for the dot in a key."""
    keys = {key.replace("__", "."): value for key, value in values.items()}
    config = with_values(_composed(), keys)
    HubStudy().check(config)
    assert isinstance(config, HubConfig)
    return config


def records(config: HubConfig, **conditions: Any) -> Records:
    return make_records_at(config, SEA | conditions, [0])


def test_the_imu_feels_the_lean_of_each_mode():
    """f = a - g sum_i slope_i q_i; with one mode that is a - g slope d."""
    one = records(plant(motion__modes=1))
    motion, slope = one.motion[0], one.source.vibration.slope[0]
    expected = motion.acceleration - 9.81 * slope * motion.position
    np.testing.assert_allclose(motion.specific_force, expected, atol=1e-12)
    assert one.sensors.tilt == slope  # what a scheme may know

    four = records(plant())
    motion, slope = four.motion[0], four.source.vibration.slope[0]
    by_first = motion.acceleration - 9.81 * slope * motion.position
    assert np.abs(motion.specific_force - by_first).max() > 1e-3


def test_the_lean_takes_the_structures_own_gravity(tmp_path):
    plain = yaml.safe_load((ROOT / "conf/structure/ren2019.yaml").read_text())
    (tmp_path / "moon.yaml").write_text(yaml.safe_dump(plain | {"gravity": 8.0}))
    config: Any = compose(
        ["motion=plant", f"structure={tmp_path}/moon.yaml", "tuning=matched", "motion.modes=1",
         "record.duration=40"]
    )  # fmt: skip
    one = records(config)
    motion, slope = one.motion[0], one.source.vibration.slope[0]  # type: ignore[attr-defined]
    felt = motion.acceleration - 8.0 * slope * motion.position
    np.testing.assert_allclose(motion.specific_force, felt, atol=1e-12)
    assert one.sensors.lean == pytest.approx(8.0 * slope, rel=1e-12)
    assert GRAVITY * config.mkf.tilt == pytest.approx(8.0 * slope, rel=1e-3)


def test_a_matched_filter_believes_in_the_first_modes_slope():
    config: Any = compose(["motion=plant", "tuning=matched", "motion.blades=[2,0]"])
    slope = PLANT.make_source(config, SEA | {"blades": 0}).vibration.slope[0]
    assert config.mkf.tilt == config.hme2.tilt == pytest.approx(slope, rel=1e-3)
    paper: Any = compose(["motion=plant", "tuning=paper"])
    assert paper.mkf.tilt == 0.0


def test_a_number_as_tilt_takes_the_place_of_the_structures():
    level = records(plant(sensors__imu__tilt=0.0)).motion[0]
    assert level.felt is None
    steep = records(plant(sensors__imu__tilt=0.02))
    motion = steep.motion[0]
    expected = motion.acceleration - 9.81 * 0.02 * motion.position
    np.testing.assert_allclose(motion.specific_force, expected, rtol=1e-12)


def test_all_sea_states_share_phases_and_noise():
    config = plant()
    one, other = records(config), records(config, hs=2.2, blades=2)
    np.testing.assert_array_equal(one.noise[0].fixes, other.noise[0].fixes)
    assert np.abs(other.motion[0].position - 1.1 * one.motion[0].position).max() > 1e-2
    higher = records(config, hs=2.2).motion[0].position
    # but for the drag, motion grows as the waves
    np.testing.assert_allclose(higher, 1.1 * one.motion[0].position, atol=2e-3)


def test_blades_angle_and_damping_reach_the_structure():
    config = plant(motion__damping=0.03)
    vibration = PLANT.make_source(config, SEA).vibration
    assert vibration.damping == 0.03
    first = vibration.frequency[0]
    assert PLANT.make_source(config, SEA | {"blades": 2}).vibration.frequency[0] < 0.95 * first
    soft, stiff = (
        PLANT.make_source(config, SEA | {"friction_angle": angle}).vibration.frequency[0]
        for angle in (28.0, 40.0)
    )
    assert soft < first < stiff


def test_both_engines_agree_on_the_plants_records():
    batch, reference = (
        rows_at(plant(engine=engine, motion__blades=[0, 1])) for engine in ("batch", "reference")
    )
    assert set(batch) == set(reference)
    assert {key[:2] for key in batch} == {(0, "MKF"), (1, "MKF")}
    for key, value in batch.items():
        assert value == pytest.approx(reference[key], rel=1e-9), key


def rows_at(config: HubConfig) -> dict[tuple[Any, ...], float]:
    study = get_study("hub")
    engine, table = study.engine(config), {}
    for block in make_plan(study, config).values():
        for _, rows in engine.run(config, [block]):
            assert list(rows)[:4] == ["hs", "tp", "blades", "friction_angle"]
            assert "amplitude" not in rows
            for row in rows.to_dict("records"):
                key = (row["blades"], row["scheme"], row["measure"], row["window"])
                table[key] = row["value"]
    return table


def test_a_run_has_tables_and_maps_over_sea_states(tmp_path):
    config = plant(
        results=str(tmp_path), motion__hs=[1.0, 3.0], motion__tp=[8.0, 6.0],
        motion__blades=[0, 2], schemes=["MKF", "HME1"], motion__friction_angle=[33.0],
        grid__replicates=2,
    )  # fmt: skip
    outcome = sweep(get_study("hub"), config)
    assert not outcome.failed
    best = outcome.run.best_scheme()
    assert list(best)[:5] == ["tuning", "hs", "tp", "blades", "friction_angle"]
    here = best[(best["criterion"] == "position") & (best["window"] == "full")]
    assert len(here) == 8
    run = outcome.run
    drawn = [file.name for file in run.draw(f"{listing.MAP}_blades_2")]
    assert f"{listing.MAP}_blades_2.png" in drawn
    assert "figure_09_position" in run.engine.drawings(config, run.tables(), run.cases(), {})
    # fewer sea states, or others, are the same run
    assert run_hash(config) == run_hash(plant(motion__hs=[2.0]))
    again = sweep(get_study("hub"), with_values(config, {"motion.hs": [3.0]}))
    assert (again.computed, again.reused) == (0, 16)


def test_maps_take_the_first_conditions_with_several_values():
    config = plant(motion__tp=[6.0, 8.0], motion__friction_angle=[30.0, 40.0])
    assert find_world(config).find_axes(config)[:2] == ["tp", "friction_angle"]
    assert list_maps(config) == {"": {"hs": 2.0, "blades": 0}}
    further = plant(motion__hs=[1.0, 2.0], motion__tp=[6.0, 8.0], motion__blades=[0, 2])
    assert list_maps(further) == {
        "": {"blades": 0, "friction_angle": "layers"},
        "_blades_2": {"blades": 2, "friction_angle": "layers"},
    }
    assert len(find_declaration(further).axes.list_cells(further)) == 8


@pytest.mark.parametrize(
    "change",
    [
        {"motion__hs": [2.1]}, {"motion__tp": [6.1]}, {"motion__blades": [1]},
        {"motion__friction_angle": [35.0]}, {"motion__gamma": 2.0}, {"motion__modes": 3},
        {"motion__damping": 0.02}, {"structure__damping": 0.02}, {"sensors__imu__tilt": 0.0},
    ],
)  # fmt: skip
def test_what_moves_the_hub_makes_another_block(change):
    study = get_study("hub")
    before, after = (make_plan(study, config) for config in (plant(), plant(**change)))
    assert set(before).isdisjoint(after)


def test_a_sea_that_breaks_is_warned_about(caplog):
    config = plant(motion__hs=[2.0, 9.0])
    with caplog.at_level(logging.WARNING):
        get_study("hub").engine(config).backend(config)
    told = [record.getMessage() for record in caplog.records]
    assert [line[:27] for line in told] == ["motion: hs 9 m with tp 6 s:"]


def test_a_structure_may_be_a_file_of_values(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text(CLAMPED)
    config = compose([*SMALL, "motion=plant", f"structure={file}"])
    assert isinstance(config, HubConfig)
    assert config.structure is not None
    assert (config.structure.name, config.structure.tubes[0].top) == ("clamped", 80.0)
    PLANT.make_source(config, SEA)
    with pytest.raises(InputError, match=r"friction_angle: structure clamped stands in no soil"):
        HubStudy().check(with_values(config, {"motion.friction_angle": [30.0]}))
    with pytest.raises(InputError, match=r"motion.blades: structure clamped has no blade"):
        HubStudy().check(with_values(config, {"motion.blades": [1]}))


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ("_target_: os.system\n", "_target_: there is no such key"),
        ("defaults: [/tuning: paper]\n", "defaults: there is no such key"),
        ("damping: ${oc.env:HOME}\n", "interpolation"),
        ("mudline: deep\n", "mudline: 'deep' is not a number"),
    ],
)
def test_a_file_with_more_than_a_structure_is_refused(tmp_path, more, told):
    file = tmp_path / "mine.yaml"
    kept = [line for line in CLAMPED.splitlines() if line.split(":")[0] != more.split(":")[0]]
    file.write_text("\n".join(kept) + "\n" + more)
    with pytest.raises(InputError) as error:
        compose(["motion=plant", f"structure={file}"])
    assert str(error.value).startswith(f"{file}: ")
    assert told in str(error.value)


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"motion__hs": [0.0]}, r"motion\.hs\[0\]: 0 m must be a finite number above zero"),
        ({"motion__tp": [6.0, 0.0]}, r"motion\.tp\[1\]: 0 s must be a finite number above zero"),
        ({"motion__tp": [60.0]}, r"motion\.tp: 60 s must be 3 to 25 s"),
        ({"motion__hs": None}, r"motion\.hs: motion=plant needs values"),
        ({"motion__friction_angle": [27.0]}, r"motion\.friction_angle\[0\]: 27 must be at least"),
        ({"motion__blades": [4]}, r"motion\.blades\[0\]: 4 is more than 3"),
        ({"motion__modes": 5000}, r"motion\.modes: 5000 of structure ren2019; give 1 to \d+"),
        ({"sensors__imu__tilt": "steep"}, r"sensors\.imu\.tilt: 'steep' is neither a number nor"),
        ({"evaluation": "superposed"}, r"evaluation: .* use evaluation=direct"),
        ({"engine": "expected"}, r"motion: engine=expected, by which .* needs the spectrum"),
        ({"record__duration": 5.5}, r"record\.duration: 5.5 s is shorter than a wave of 6 s"),
        ({"structure__soil": None}, r"structure: it floats"),
        ({"structure": None}, r"structure: motion=plant needs one; use e.g. structure=ren2019"),
        ({"motion__kind": "spectrum"}, r"sensors\.imu\.tilt: `structure` needs a structure"),
        ({"motion__kind": "spectrum", "sensors__imu__tilt": 0.0, "structure": None},
         r"motion\.hs: motion=spectrum"),
        ({"grid__replicates": 1000000, "motion__hs": [0.01 * n for n in range(1, 900)]},
         r"motion: a sweep would have .* give fewer significant wave heights, peak periods"),
    ],
)  # fmt: skip
def test_bad_input_is_told_in_a_line(values, told):
    with pytest.raises(InputError, match=f"^{told}"):
        plant(measures__settling_time=1.0, **values)


@pytest.mark.parametrize("command", ["tune", "spectrum"])
def test_commands_that_need_a_spectrum_say_so(command, tmp_path, capsys):
    assert main([command, "motion=plant", f"results={tmp_path}"]) == 2
    assert f"motion: `{command}` needs the spectrum of the motion" in capsys.readouterr().err
    assert not list(Path(tmp_path).iterdir())


def test_fidelity_judges_the_time_histories_alone(tmp_path):
    """F9 and F11 are judged, in the sea of the run that is nearest to Hs 2 m and Tp 6 s."""
    config = plant(
        results=str(tmp_path), motion__hs=[1.0, 3.0], motion__tp=[6.0, 9.0],
        schemes=["HME1", "HME2"], grid__replicates=2,
    )  # fmt: skip
    folder = sweep(get_study("hub"), config).run.folder
    fidelity.main(str(folder))
    claims = pd.read_csv(folder / "fidelity" / "fidelity_claims.csv")
    assert list(claims["statement"]) == ["F9", *["F11"] * 3]
    assert claims["decided_at"].str.startswith("hs 1 m, tp 6 s, blades 0").all()

    errors = measure_histories(config)
    assert errors is not None
    sums = errors.set_index(["quantity", "measure", "scheme", "replicate"])["value"]
    position = [sums["position", "accumulated", name].mean() for name in ("HME1", "HME2")]
    assert claims["value"][1] == pytest.approx(position[0] / position[1], rel=1e-9)
    # the second way: the estimates that figures 9-14 draw, of record 0
    shown = simulate_histories(with_values(config, {"motion.hs": [1.0], "motion.tp": [6.0]}))
    error = np.abs(shown.estimated["HME1"].values["position"] - shown.truth["position"])
    total = error.sum() * shown.time[1]
    assert sums["position", "accumulated", "HME1", 0] == pytest.approx(total, rel=1e-9)


def test_fidelity_needs_the_two_schemes_of_the_statements(tmp_path, capsys):
    folder = sweep(get_study("hub"), plant(results=str(tmp_path))).run.folder
    with pytest.raises(InputError, match="are about HME1 and HME2; run a sweep with schemes="):
        fidelity.main(str(folder))
    capsys.readouterr()
    assert main(["fidelity", str(folder)]) == 2
    told = "the rows of a run judge none of these statements"
    assert told in capsys.readouterr().err
    assert not (folder / "fidelity").exists()


def test_figures_3_and_4_show_the_sea_of_the_paper():
    """Record 0 at the sea nearest to Hs 2 m and Tp 8 s, with the structure's own period."""
    config = plant(motion__hs=[1.0, 2.0, 4.0], motion__tp=[6.0, 8.0], record__duration=400.0)
    shown = record_and_spectrum.draw_record(config)
    assert "hs 2 m, tp 8 s, blades 0: natural period 3.89 s" in shown.get_suptitle()
    sea = SEA | {"tp": 8.0}
    position = records(config, **sea).motion[0].position
    north = np.asarray(shown.axes[0].lines[0].get_ydata())
    assert np.abs(north).max() == pytest.approx(np.cos(np.pi / 6) * np.abs(position).max())

    spectrum = record_and_spectrum.draw_spectrum(config).axes[0]
    lines = {line.get_label(): line for line in spectrum.lines}
    frequency, density = lines["this record (Welch)"].get_data()
    first = PLANT.make_source(config, sea).vibration.frequency[0]
    assert np.asarray(frequency)[np.argmax(density)] == pytest.approx(first, abs=0.005)
    assert lines["first mode"].get_xdata()[0] == pytest.approx(first)
    assert lines["peak of the waves"].get_xdata()[0] == pytest.approx(0.125)


@pytest.mark.parametrize(
    "flags", [[], ["--dry-run"], ["engine=batch"], ["engine=batch", "--dry-run"]]
)
def test_vary_needs_a_spectrum_and_says_so_first(flags, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ["motion=plant", "sensors.gnss.rate=1,2", *flags]
    assert main(["vary", *words]) == 2
    told = capsys.readouterr().err
    assert re.search(r"`vary`.* needs the spectrum of the motion.*; leave out motion=plant", told)
    assert told.count("\n") == 1
    assert not list(Path(tmp_path).iterdir())


def test_show_lists_the_sea_states_of_a_run(tmp_path, capsys):
    words = ["motion.hs=[2]", "motion.tp=[6,8]", "grid.replicates=1", "record.duration=30"]
    schemes = ["schemes=[MKF]", "baselines=[]", "tuning=paper", "sensors.imu.rate=20"]
    owtsweep.run(["motion=plant", *words, *schemes, f"results={tmp_path}", "name=run"])
    assert main(["show", str(tmp_path / "run")]) == 0
    (told,) = re.findall(r"\* \d{4}-.*", capsys.readouterr().out)
    assert "hs (1), tp (2), blades (1), replicates 1, schemes MKF" in told
    assert "natural_period" not in told
