"""`advise` against what a user would do by hand: single sweeps, their records side by side."""

import json

import numpy as np
import pytest

import owtsweep
from owtsweep import InputError
from owtsweep.advice import worlds
from owtsweep.cli.program import main
from owtsweep.studies.hub.study import HubStudy

pytestmark = pytest.mark.usefixtures("kernels")

CASE = ["natural_period=4", "amplitude=0.5", "record.duration=60", "schemes=[MKF,HME1]"]
#: The same case as a sweep has it.
CELL = ["grid.natural_period=[4]", "grid.amplitude=[0.5]", *CASE[2:]]
RECORDS = 8
#: Worlds that are tried here, two at once and then one: of the sensors and of the motion.
WORLDS = ("leaning_out", "red_fixes", "two_peaks")


@pytest.fixture(scope="module")
def advice(tmp_path_factory):
    """The whole advice for a short case; further records and most worlds are left out."""

    def list_some(study, config):
        return {name: told for name, told in whole(study, config).items() if name in WORLDS}

    whole = HubStudy.list_worlds
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("advice"))
        patch.setattr(HubStudy, "advised_records", 40)
        patch.setattr(HubStudy, "list_worlds", list_some)
        patch.setattr(worlds, "AT_ONCE", 2)
        yield owtsweep.advise(CASE)


def squares(words, scheme):
    """Return the mean square errors of a scheme's first records, by a sweep."""
    cases = owtsweep.run([*CELL, f"grid.replicates={RECORDS}", *words]).cases()
    wanted = cases.loc[
        (cases["scheme"] == scheme)
        & (cases["measure"] == "position")
        & (cases["window"] == "settled")
    ].sort_values("replicate")
    amplitude = 0.5
    return (
        amplitude**2 * wanted["motion"] + 2 * amplitude * wanted["cross"] + wanted["noise"]
    ).to_numpy()


def test_the_answer_is_that_of_a_sweep(advice, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    best = owtsweep.run(CELL).best_scheme().set_index("criterion").loc["position"]
    plain = advice.as_plain()
    assert (plain["scheme"], plain["verdict"]) == (best["best"], best["verdict"])
    assert advice.answer.error.value == pytest.approx(best["error_best"], rel=1e-12)
    assert plain["runner_up_error"] == pytest.approx(best["error_runner_up"], rel=1e-12)
    assert plain["baseline"] == best["baseline"]


@pytest.mark.parametrize("motion", ["peaks=[0.1,0.26]", "pace=[[10,1],[50,1.1]]"])
def test_a_motion_of_no_steady_spectrum_has_an_answer_and_no_bound(motion, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    plain = owtsweep.advise([*CASE, f"motion.{motion}"], quick=True).as_plain()
    assert plain["scheme"] in ("MKF", "HME1", "NONE", "HOLD", "DELTA")
    assert plain["bound"] is None


def test_the_closer_error_is_the_mean_of_more_records(advice, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    best = advice.as_plain()["scheme"]
    mean = squares(["grid.replicates=40"], best).mean()
    assert advice.closer.n == 40
    assert advice.closer.value == pytest.approx(np.sqrt(mean), rel=1e-9)
    # it takes the longest, so it comes last
    assert advice.lines[-1].startswith(f"Over more records the error of {best} is ")


def test_a_lever_is_the_ratio_of_paired_sweeps(advice, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    pulled = next(p for p in advice.levers if p.change.startswith("sensors.gnss.sigma="))
    name, value = pulled.change.split("=")
    given = owtsweep.run([*CELL, "grid.replicates=1"]).config.sensors.gnss.sigma
    assert (name, float(value)) == ("sensors.gnss.sigma", given / 2)
    ratio = squares([pulled.change], pulled.best).mean() / squares([], advice.answer.best).mean()
    assert pulled.ratio.value == pytest.approx(np.sqrt(ratio), rel=1e-9)
    assert pulled.ratio.low <= pulled.ratio.value <= pulled.ratio.high


def test_a_world_has_the_regret_of_the_key_over(advice, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = [f"grid.replicates={RECORDS}", "over={world: [nominal,red_fixes]}"]
    table = owtsweep.run([*CELL, *words]).regret().set_index(["world", "scheme"])
    line = table.loc["red_fixes", advice.answer.best]
    turned = next(each for each in advice.worlds if each.world == "red_fixes")
    assert turned.error == pytest.approx(line["error"], rel=1e-12)
    assert turned.regret == pytest.approx(line["regret"], rel=1e-12)
    assert turned.best == line["best"]
    errors = table.loc["red_fixes", "error"].sort_values()
    assert turned.second == errors.index[1]
    assert turned.ratio == pytest.approx(errors.iloc[1] / errors.iloc[0], rel=1e-12)


def test_every_lever_and_world_has_a_line(advice):
    text = str(advice)
    assert all(pulled.change in text for pulled in advice.levers)
    assert sorted(turned.world for turned in advice.worlds) == sorted(WORLDS)
    assert all(f"({turned.world})" in text for turned in advice.worlds)
    assert "Most is bought by" in text
    assert "If nobody knows the world" in text
    found, best = advice.answer.found, advice.answer.best
    nominal = np.sqrt(found.values[best][:RECORDS].mean())
    assert f"As asked (nominal): {best}, {nominal:#.3g} m." in text
    assert found.measure(best, 3).value == pytest.approx(np.sqrt(found.values[best][:3].mean()))


def test_a_world_that_is_refused_takes_no_other_with_it(advice, monkeypatch):
    whole = worlds._run

    def run(question, names):
        if "red_fixes" in names:
            raise InputError("red_fixes: refused")
        return whole(question, names)

    monkeypatch.setattr(worlds, "_run", run)
    tried = [*worlds.try_worlds(advice.question, advice.answer)]
    assert [each.world for each in tried] == [each.world for each in advice.worlds]
    assert [each.world for each in tried if each.refused] == ["red_fixes"]


def test_levers_of_fewer_records_are_paired_over_these(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("owtsweep.advice.advising.try_worlds", lambda *_: iter(()))
    monkeypatch.setattr("owtsweep.advice.advising.measure_closely", lambda *_: None)
    monkeypatch.setattr(HubStudy, "levers", HubStudy.levers[:1])
    advice = owtsweep.advise([*CASE, "grid.replicates=3"])
    assert {pulled.ratio.n for pulled in advice.levers} == {3}


def test_a_lever_that_does_not_fit_is_moved_to_one_that_does(tmp_path, monkeypatch):
    """10 fixes per second do not become 20 beside an IMU of 50 Hz, nor a delay of .1 s .05 s."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("owtsweep.advice.advising.try_worlds", lambda *_: iter(()))
    monkeypatch.setattr("owtsweep.advice.advising.measure_closely", lambda *_: None)
    monkeypatch.setattr(HubStudy, "levers", HubStudy.levers[:3])
    sensors = ["sensors.gnss.rate=10", "sensors.imu.rate=50", "sensors.gnss.delay=.1"]
    advice = owtsweep.advise([*CASE, *sensors, "grid.replicates=3"])
    changes = {pulled.change: pulled for pulled in advice.levers}
    assert not any(pulled.refused for pulled in advice.levers)
    assert changes["sensors.gnss.rate=25"].words == "nearly twice as many fixes"
    assert changes["sensors.gnss.delay=0.04"].words == "nearly half the delay of a fix"


def test_quick_is_the_answer_alone_and_json_one_object(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["advise", *CASE, "--quick", "--json"]) == 0
    plain = json.loads(capsys.readouterr().out)
    assert plain["cell"] == {"natural_period": 4.0, "amplitude": 0.5}
    assert plain["levers"] == plain["worlds"] == []
    assert plain["error_low"] < plain["error"] < plain["error_high"]
    assert plain["bound"] < plain["error"]


def test_advice_leaves_the_runs_of_sweeps_alone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    owtsweep.advise([*CASE, "results=mine"], quick=True)
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["advice"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "natural_period and amplitude: advice is for one case"),
        (["natural_period=3"], "amplitude: advice is for one case"),
        (["natural_period=3,4", "amplitude=1"], "natural_period: advice is for one case"),
        (["natural_perod=3", "amplitude=1"], "did you mean grid.natural_period"),
        (["natural_period=0.5", "amplitude=1"], "outside band [0.05, 0.6] Hz"),
        (["natural_period=x", "amplitude=1"], "'x' is not a number"),
        ([*CASE, "tuning=[paper,matched]"], "several tunings"),
        ([*CASE, "name=mine"], "name: `advise` names its folders"),
        ([*CASE, "engine=expected"], "engine: advice rests on records"),
        ([*CASE, "over={world: [nominal]}", "grid.replicates=8"], "over: `advise` asks"),
        (["study=replay"], "needs records"),
        (["study=tower", "noise=1"], "soil_factor: advice is for one case"),
    ],
)
def test_bad_questions_are_refused_in_a_line(words, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError) as error:
        owtsweep.advise(words)
    assert message in str(error.value)
    assert "\n" not in str(error.value)
    assert list(tmp_path.iterdir()) == []
