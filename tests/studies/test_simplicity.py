"""How simple each scheme is: known without its code, no two of a study alike, a user's own last."""

from __future__ import annotations

import sys
from importlib.metadata import EntryPoint

import own_schemes
import pytest

from owtsweep import load, run
from owtsweep.cli import main
from owtsweep.errors import InputError
from owtsweep.studies import compose, get_study, names
from owtsweep.studies.base import schemes
from owtsweep.studies.base.schemes import LEAST_SIMPLE
from owtsweep.studies.hub.contract import BASELINES, SCHEMES
from owtsweep.studies.registry import list_simplicity

STUDIES = [name for name in names() if get_study(name).schemes()]
TINY = [
    "study=floater", "record.duration=60", "record.rate=10", "record.settling=20", "grid.delay=[0]",
    "grid.bias=[0.1]", "grid.replicates=2", "compute=single", "name=mine",
]  # fmt: skip


@pytest.mark.parametrize("study", STUDIES)
def test_no_two_schemes_of_a_study_are_equally_simple(study: str) -> None:
    simplicity = list_simplicity(study)
    assert {*simplicity} == {*get_study(study).schemes()}
    assert len({*simplicity.values()}) == len(simplicity)
    assert 0 <= min(simplicity.values()) <= max(simplicity.values()) < LEAST_SIMPLE


def test_baselines_come_first_and_schemes_with_a_latency_last() -> None:
    hub = list_simplicity("hub")
    assert sorted(hub, key=hub.__getitem__)[: len(BASELINES)] == ["NONE", "HOLD", "DELTA"]
    late = {
        "tower": {"AKF_LAGGED", "MDE"},
        "floater": {"FIXED_LAG"},
        "blade": {"FIXED_LAG", "SMOOTHER", "DOUBLE_INTEGRATION", "TOTAL_STATIONS"},
    }
    for study, waiting in late.items():
        found = list_simplicity(study)
        assert {name for name, number in found.items() if number > 1000} == waiting
    assert list_simplicity("mating") == list_simplicity("blade")


def test_contenders_are_ranked_the_simplest_first() -> None:
    """With baselines, each once; a user's scheme after one of ours that says the same."""
    hub = compose(["schemes=[HME2,DELTA,EKF,MKF]", "tuning=matched"])
    assert SCHEMES.rank(hub) == {"NONE": 0, "HOLD": 2, "DELTA": 4, "MKF": 17, "EKF": 18, "HME2": 33}
    own = "{_target_:own_schemes.Held},{_target_:own_schemes.Plain},LOWPASS,KF"
    table = get_study("floater").scheme_table()
    floater = compose([*TINY, f"schemes=[{own}]"])
    assert [*table.rank(floater).items()] == [
        ("LOWPASS", 18), ("PLAIN", 18), ("KF", 33), ("HELD", LEAST_SIMPLE),
    ]  # fmt: skip


@pytest.mark.parametrize("value", [-1, 2.5, "low", True, None])
def test_a_simplicity_that_is_no_number_is_refused_in_one_line(
    value: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(own_schemes.Held, "simplicity", value)
    with pytest.raises(InputError, match=r"schemes: HELD has simplicity = .*; give a whole number"):
        compose([*TINY, "schemes=[{_target_:own_schemes.Held}]"])


def test_a_stored_run_ranks_a_users_scheme_without_its_code(
    monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    monkeypatch.chdir(tmp_path_factory.mktemp("stored"))
    run([*TINY, "schemes=[KF,{_target_:own_schemes.Plain}]"])
    monkeypatch.setitem(sys.modules, "own_schemes", None)
    config = load("results/mine").config
    assert get_study("floater").scheme_table().rank(config) == {"PLAIN": 18, "KF": 33}


def test_a_scheme_of_another_package_says_its_own_and_is_last_where_it_is_absent(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    points = [EntryPoint("PLAIN", "own_schemes:Plain", "owtsweep.schemes")]
    monkeypatch.setattr(schemes, "entry_points", lambda group: points)
    config, table = compose([*TINY, "schemes=[PLAIN,KF]"]), get_study("floater").scheme_table()
    assert table.rank(config) == {"PLAIN": 18, "KF": 33}
    assert main(["list"]) == 0
    assert "  PLAIN               - own_schemes:Plain, of another" in capsys.readouterr().out
    points.clear()
    assert table.rank(config) == {"KF": 33, "PLAIN": LEAST_SIMPLE}


def test_list_shows_the_simplest_first_and_says_once_what_the_number_is(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["list"]) == 0
    out = capsys.readouterr().out
    assert out.count("states + tuned numbers") == 1
    lines = out[out.index("study=blade schemes") :].splitlines()[1:15]
    shown = {line.split()[0]: int(line.split()[1]) for line in lines}
    assert [*shown.items()] == sorted(list_simplicity("blade").items(), key=lambda item: item[1])
