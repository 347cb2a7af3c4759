"""F1 to F11: statements that stand, fall or stay open."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest
from fidelity_worlds import (
    BEST_EKF,
    EQUAL,
    Terms,
    growing,
    hme2_beyond,
    mkf_at_two_cells,
    mkf_far_from_hme1,
    shrinking,
    world,
)

from experiments.ren2019.evidence import tolerated
from experiments.ren2019.fidelity import CLAIMS, judge_all, judge_along_x
from experiments.ren2019.histories import COLUMNS
from experiments.ren2019.numbers import compare_numbers
from experiments.ren2019.published import BOUNDARIES
from experiments.ren2019.summaries import fidelity_table, statement_row
from owtsweep.verdicts.inference import (
    MISSING,
    NOT_REPRODUCED,
    REPRODUCED,
    UNDECIDED,
    JudgedStatement,
)
from owtsweep.verdicts.judge import judge
from owtsweep.verdicts.score_table import ScoreTable


def velocity_only(hme1: float, hme2: float) -> Callable[[str, float], dict[str, Terms]]:
    """HME1 and HME2 differ in velocity alone."""

    def terms(measure: str, period: float) -> dict[str, Terms]:
        own = {"HME1": (hme1, 0.01), "HME2": (hme2, 0.01)} if measure == "velocity" else {}
        return {**EQUAL, **own}

    return terms


def judge_one(name: str, *scores: ScoreTable) -> JudgedStatement:
    """Judge the statement of that name."""
    (judged,) = judge([s for s in CLAIMS.statements if s.name == name], scores, CLAIMS)
    return judged


RESTLESS = {"HME2": 0.6}
CASES = [
    ("F1", REPRODUCED, BEST_EKF, None),
    ("F1", NOT_REPRODUCED, {**BEST_EKF, "EKF": (9.0, 1e3)}, None),
    ("F1", NOT_REPRODUCED, {**BEST_EKF, "EKF": (0.1, 1e-3)}, None),
    ("F1", UNDECIDED, {**BEST_EKF, "EKF": (5.0 - 2.5, 1e3)}, {"EKF": 0.6}),
    ("F2", REPRODUCED, mkf_at_two_cells, None),
    ("F2", NOT_REPRODUCED, {**EQUAL, "MKF": (9.0, 1.0)}, None),
    ("F2", NOT_REPRODUCED, {**EQUAL, "MKF": (1.9, 0.001)}, None),
    ("F2", NOT_REPRODUCED, mkf_far_from_hme1, None),
    ("F2", UNDECIDED, EQUAL, {"MKF": 0.3}),
    ("F3", REPRODUCED, hme2_beyond(0.3), None),
    ("F3", NOT_REPRODUCED, hme2_beyond(1.2), None),
    ("F3", NOT_REPRODUCED, hme2_beyond(0.1), None),
    ("F3", UNDECIDED, hme2_beyond(0.6), RESTLESS),
    ("F4", REPRODUCED, hme2_beyond(1.0), None),
    ("F4", NOT_REPRODUCED, hme2_beyond(0.3), None),
    ("F4", UNDECIDED, hme2_beyond(2.0), RESTLESS),
    ("F5", REPRODUCED, growing, None),
    ("F5", NOT_REPRODUCED, shrinking, None),
    ("F5", NOT_REPRODUCED, lambda m, p: {**growing(m, p), "MKF": (0.5, 9.0)}, None),
    ("F5", UNDECIDED, hme2_beyond(1.0), RESTLESS),
    ("F6", REPRODUCED, {**EQUAL, "HME1": (4.0, 0.01), "HME2": (3.0, 0.01)}, None),
    ("F6", NOT_REPRODUCED, {**EQUAL, "HME1": (4.0, 0.01), "HME2": (2.0, 0.01)}, None),
    ("F6", NOT_REPRODUCED, {**EQUAL, "HME1": (4.0, 0.01), "HME2": (3.8, 0.01)}, None),
    ("F6", UNDECIDED, {**EQUAL, "HME1": (4.0, 0.0), "HME2": (3.4, 0.0)}, {"HME2": 0.1}),
    ("F7", REPRODUCED, hme2_beyond(1.0), None),
    ("F7", NOT_REPRODUCED, hme2_beyond(3.0), None),
    ("F7", UNDECIDED, hme2_beyond(2.0), RESTLESS),
    ("F8", REPRODUCED, velocity_only(2.0, 1.5), None),
    ("F8", NOT_REPRODUCED, velocity_only(1.5, 2.0), None),
    ("F8", UNDECIDED, velocity_only(2.0, 2.0), RESTLESS),
    ("F10", REPRODUCED, EQUAL, None),
    ("F10", NOT_REPRODUCED, {**EQUAL, "MKF": (9.0, -0.01)}, None),
    ("F10", UNDECIDED, {**EQUAL, "MKF": (9.0, 0.0)}, {"MKF": 0.5}),
]  # fmt: skip


@pytest.mark.parametrize(("name", "verdict", "terms", "wobble"), CASES)
def test_statement(name, verdict, terms, wobble):
    assert judge_one(name, world(terms, wobble=wobble).scores).verdict == verdict


def sums(**position) -> dict[tuple[str, str], np.ndarray]:
    """Accumulated errors: HME1 worse by these factors than HME2, by quantity."""
    base = np.array([1.0, 1.02, 0.99, 1.01])
    apart = {"HME1": np.array([1.0, -1.0, -1.0, 1.0]), "HME2": np.array([-1.0, 1.0, 1.0, -1.0])}
    factors = {"position": (0.8, 0.0), "velocity": (1.2, 0.0), "bias": (1.1, 0.0), **position}
    return {
        (scheme, quantity): base * (factor if scheme == "HME1" else 1.0) + spread * apart[scheme]
        for quantity, (factor, spread) in factors.items()
        for scheme in ("HME1", "HME2")
    }


@pytest.mark.parametrize(
    ("name", "verdict", "inside", "accumulated"),
    [
        ("F9", REPRODUCED, [0.97, 0.98, 0.96, 0.97], sums()),
        ("F9", NOT_REPRODUCED, [0.91, 0.92, 0.90, 0.91], sums()),
        ("F9", UNDECIDED, [0.90, 1.00, 0.93, 0.96], sums()),
        ("F11", REPRODUCED, [1.0] * 4, sums()),
        ("F11", NOT_REPRODUCED, [1.0] * 4, sums(position=(1.2, 0.0))),
        ("F11", NOT_REPRODUCED, [1.0] * 4, sums(velocity=(0.9, 0.0))),
        ("F11", NOT_REPRODUCED, [1.0] * 4, sums(bias=(0.9, 0.0))),
        ("F11", UNDECIDED, [1.0] * 4, sums(bias=(1.01, 0.2))),
    ],
)
def test_history_statement(name, verdict, inside, accumulated):
    shares = {"HME1": np.array(inside), "HME2": np.full(len(inside), 0.99)}
    measured = {(s, "velocity", "share_inside"): share for s, share in shares.items()}
    measured |= {(s, q, "accumulated"): errors for (s, q), errors in accumulated.items()}
    rows = [
        ("3.8 s, 0.5 m", *key, replicate, value)
        for key, values in measured.items()
        for replicate, value in enumerate(values)
    ]
    histories = ScoreTable(pd.DataFrame(rows, columns=COLUMNS))
    assert judge_one(name, world(EQUAL, periods=[4.0]).scores, histories).verdict == verdict


def test_cells_and_schemes_that_the_run_lacks_are_named():
    few = world(growing, periods=[4.0])
    judged = {statement.name: statement for statement in judge_all([few.scores])}
    verdicts = {name: statement.verdict for name, statement in judged.items()}
    assert verdicts["F3"] == REPRODUCED  # all it needs is there
    assert verdicts["F1"] == NOT_REPRODUCED  # what is there is enough to fall
    assert {verdicts[name] for name in ("F4", "F5", "F7", "F10")} == {MISSING}
    assert judged["F7"].claims[0].missing == ("3 s, 2 m",)
    assert "3 s, 0.05 m" in judged["F1"].claims[0].missing

    alone = world(growing, schemes=["HME1"])
    of_one = judge_all([alone.scores])
    assert [statement.name for statement in of_one] == [f"F{i}" for i in range(1, 12)]
    assert {statement.verdict for statement in of_one} == {MISSING}
    numbers = compare_numbers(alone)
    assert (numbers["scheme"][numbers["reproduced"].notna()] == "HME1").all()
    table = fidelity_table(alone, numbers, of_one, judge_along_x([alone.scores]))
    assert set(table.loc[table["kind"].isin(["winner", "statement"]), "agrees"]) == {MISSING}
    assert "not in this run" in table["why"][0]


def test_f1_to_f5_are_judged_in_x_alone_too():
    """In x + y the boundary is at 1.2 m, in x alone at .3 m; F6 and on are judged once."""

    def terms(measure: str, period: float) -> dict[str, Terms]:
        return hme2_beyond({"x": 0.3}.get(measure, 1.2))

    evidence = world(terms, measures=("position", "velocity", "x"))
    verdicts = {statement.name: statement.verdict for statement in judge_all([evidence.scores])}
    along_x = judge_along_x([evidence.scores])
    assert [statement.name for statement in along_x] == [f"F{i}, x alone" for i in range(1, 6)]
    in_x = {statement.name: statement.verdict for statement in along_x}
    assert (verdicts["F3"], in_x["F3, x alone"]) == (NOT_REPRODUCED, REPRODUCED)
    assert (verdicts["F4"], in_x["F4, x alone"]) == (REPRODUCED, NOT_REPRODUCED)
    table = fidelity_table(
        evidence, compare_numbers(evidence), judge_all([evidence.scores]), along_x
    ).set_index("item")
    assert table.loc["boundary 4 s, x alone", "reproduced"] == pytest.approx(0.3, rel=1e-3)
    assert table.loc["boundary 4 s", "reproduced"] == pytest.approx(1.2, rel=1e-3)
    assert table.loc["F3, x alone", "agrees"] == REPRODUCED


def test_a_definition_is_printed_with_each_statement():
    for statement in judge_all([world(EQUAL, periods=[4.0]).scores]):
        assert len(statement.definition) > 60
        assert "\n" not in statement_row(statement).why


def test_boundaries_are_claimed_within_what_is_tolerated():
    for name, period in (("F3", 4.0), ("F4", 6.0)):
        (statement,) = (s for s in CLAIMS.statements if s.name == name)
        parts = statement.claims[0].parts
        assert [part.side for part in parts] == ["above", "below"]
        assert tuple(part.bound for part in parts) == tolerated(period)
        assert statement.claims[0].parts[0].select["natural_period"] == (period,)
    assert set(BOUNDARIES) == {4.0, 6.0}


def test_sections_are_those_of_the_print():
    assert [s.name for s in CLAIMS.statements] == [f"F{number}" for number in range(1, 12)]
    printed = {statement.printed for statement in CLAIMS.statements}
    assert printed == {"section 5.2", "section 5.3", "section 5.4"}
