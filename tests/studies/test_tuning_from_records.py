"""`tune` of the studies with records: what it searches, what it writes, how it judges."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_tower import SMALL_TOWER

from owtsweep import InputError
from owtsweep.cli import BAD_INPUT, DONE, main
from owtsweep.cli.running import require_serving
from owtsweep.config import with_values
from owtsweep.config.hints import list_keys
from owtsweep.studies.base.study import DeclaredStudy
from owtsweep.studies.base.tuning.training import Training, choose_cells
from owtsweep.studies.base.tuning.tuned import list_searched
from owtsweep.studies.registry import compose, get_study

#: Searches of some seconds: short records of one cell.
QUICK = [
    "study=floater", "record.duration=60", "record.settling=10", "grid.delay=[4]",
    "grid.bias=[0.03]", "tune.trials=5", "tune.training=2", "tune.replicates=3",
]  # fmt: skip


def find(name: str) -> tuple[DeclaredStudy, Any]:
    """Return a study, and what it declares for `tune`."""
    study = get_study(name)
    assert isinstance(study, DeclaredStudy)
    return study, study._find("tuning", "SEARCHED")


@pytest.mark.parametrize("name", ["floater", "tower", "blade"])
def test_what_is_declared_exists(name: str) -> None:
    study, searched = find(name)
    keys = list_keys(study.config_type())
    for part in searched:
        assert {*part.schemes} <= {*study.schemes()}
        assert {*part.space} <= {*keys}
        assert all(key.split(".")[0] in study.config_type().tuned for key in part.space)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("floater", ["schemes=[KF_BIAS]", "filters.process=declared"]),
        ("floater", ["schemes=[PASSIVE_OBSERVER]"]),
        ("blade", ["schemes=[PENDULUM]"]),
        ("tower", ["schemes=[AKF]", *SMALL_TOWER]),
    ],
)
def test_every_number_that_counts_changes_the_errors(name: str, words: list[str]) -> None:
    study, searched = find(name)
    short = [] if name == "tower" else ["record.duration=130", "record.settling=30"]
    config: Any = compose([f"study={name}", "tuning=matched", *short, *words])
    cells = choose_cells(study.contest(), config)[-1:]
    training = Training(study.declaration(), config, cells, 1, 1)
    (part,) = list_searched(searched, config)
    before = training.run(config, part.schemes[0], config.criterion)
    assert np.array_equal(before, training.run(config, part.schemes[0], config.criterion))
    for key, (low, high, _) in part.space.items():
        for value in (low, high):
            after = training.run(
                with_values(config, {key: value}), part.schemes[0], config.criterion
            )
            assert after[0, 0] != before[0, 0]


def test_a_search_is_repeatable_and_its_file_is_taken(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.yaml"
    words = [*QUICK, "schemes=[COMPLEMENTARY,KF]", "filters.crossover=0.1"]
    assert main(["tune", *words, "--output", str(path)]) == DONE
    out = capsys.readouterr().out
    text = path.read_text()
    assert "Searched: filters.crossover for COMPLEMENTARY." in text
    assert f"tuning={path}" in out
    taken: Any = compose([*QUICK, f"tuning={path}"])
    assert taken.tuning == "mine"
    assert taken.filters.crossover != 0.1
    change = next(line for line in out.splitlines() if line.strip().startswith("COMPLEMENTARY"))
    assert "-" in change.split()[3]  # less error on records that the search has not seen
    assert main(["tune", *words, "--output", str(path)]) == DONE
    assert path.read_text() == text


def test_of_a_large_map_corners_and_middle_are_searched() -> None:
    study, _ = find("floater")
    config: Any = compose(["study=floater"])
    cells = choose_cells(study.contest(), config)
    pairs = {(cell["delay"], cell["bias"]) for cell in cells}
    assert pairs == {(0, 0.0), (0, 0.3), (16, 0.0), (16, 0.3), (4, 0.03)}


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["schemes=[KF]"], "with tuning=matched these have no numbers to search"),
        (["tune.seed=2018"], "tune.seed: 2018 is also the run's seed"),
        (["tuning=[matched,paper]"], "tuning: a search begins with one tuning"),
    ],
)
def test_bad_input_is_one_line(
    words: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["tune", *QUICK, *words]) == BAD_INPUT
    err = capsys.readouterr().err
    assert says in err
    assert err.count("\n") == 1


def test_mating_has_no_numbers_of_its_own() -> None:
    with pytest.raises(InputError, match="`tune` serves hub, tower, floater, blade only"):
        require_serving("tune", "mating")
