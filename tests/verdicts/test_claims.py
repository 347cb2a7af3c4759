"""Claims about many cells, statements made of them, and a published number beside records."""

from __future__ import annotations

from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pandas as pd
import pytest

from owtsweep.results.conditions import Condition
from owtsweep.results.status import OK
from owtsweep.verdicts.claims import claim_against_best, claim_ratio, gather
from owtsweep.verdicts.evidence import Evidence
from owtsweep.verdicts.inference import MISSING, NOT_REPRODUCED, REPRODUCED, mean_ratio
from owtsweep.verdicts.numbers import COLUMNS, compare_number, lies_within_records
from owtsweep.verdicts.statements import judge, tabulate_claims

SMALL = np.array([1.0, 1.1, 0.9, 1.0])
LARGE = np.array([2.0, 2.2, 2.1, 1.9])


class Cell(NamedTuple):
    """A sea, by its wave height (m)."""

    height: float

    def __str__(self):
        return {1.0: "calm", 4.0: "rough"}.get(self.height, "storm")


CALM, ROUGH, STORM = Cell(1.0), Cell(4.0), Cell(9.0)


def evidence():
    """A run of two schemes, good and bad, in a calm and a rough sea."""
    rows = [
        {"scheme": scheme, "height": sea.height, "measure": "position", "window": "full",
         "replicate": replicate, "value": value, "status": OK}
        for scheme, values in {"good": SMALL, "bad": LARGE}.items()
        for sea in (CALM, ROUGH)
        for replicate, value in enumerate(values)
    ]  # fmt: skip
    return Evidence(
        rows=pd.DataFrame(rows),
        conditions=[Condition("height", "wave height", "m")],
        grid={"height": (1.0, 4.0)},
        schemes=("good", "bad"),
        rivals=("good", "bad"),
        window="full",
    )


def test_what_a_run_lacks_is_named_and_the_rest_decided():
    decision = mean_ratio("here", SMALL, LARGE, 1.0, "below")
    parts = [("here", decision), ("here", decision), ("there", None), ("there", None)]
    claim = gather("it is less", parts)
    assert claim.decisions == (decision, decision)
    assert claim.missing == ("there",)
    assert claim.verdict == MISSING


@pytest.mark.parametrize(("side", "verdict"), [("below", REPRODUCED), ("above", NOT_REPRODUCED)])
def test_ratios_are_claimed_in_every_cell(side, verdict):
    claims = [
        claim_ratio("", evidence(), ("good", "bad"), [CALM, ROUGH], side),
        claim_against_best("", evidence(), "good", [CALM, ROUGH], side),
    ]
    for claim in claims:
        assert claim.verdict == verdict
        labels = [decision.label for decision in claim.decisions]
        assert labels == ["calm: good / bad", "rough: good / bad"]
    assert claim_ratio("", evidence(), ("good", "bad"), [STORM], side).missing == ("storm",)


def test_statements_are_judged_by_their_tests_in_the_order_of_the_texts():
    def wins(errors):
        """Good over bad:
        below 1 everywhere."""
        return [claim_ratio("good wins", errors, ("good", "bad"), [CALM], "below")]

    def loses(errors):
        """Good over bad: above 1."""
        return [claim_ratio("bad wins", errors, ("good", "bad"), [CALM, STORM], "above")]

    texts = {"second": "good loses", "first": "good wins"}
    judged = judge(texts, {"first": wins, "second": loses}, evidence())
    assert [statement.name for statement in judged] == ["second", "first"]
    assert [statement.verdict for statement in judged] == [NOT_REPRODUCED, REPRODUCED]
    assert judged[1].definition == "Good over bad: below 1 everywhere."
    assert judged[1].why.startswith(
        "good wins: reproduced, 1 of 1 hold in the mean, calm: good / bad"
    )
    table = tabulate_claims(judged)
    assert table["missing"].tolist() == ["storm", ""]
    assert table["threshold"].tolist() == [1.0, 1.0]
    assert table["holding"].tolist() == [0, 1]


def test_a_published_number_has_its_place_among_the_records():
    records = np.arange(1.0, 102.0)
    compared = compare_number(records, 51.0)
    assert list(compared) == list(COLUMNS)
    assert compared["reproduced"] == compared["ratio"] * 51.0 == 51.0
    assert (compared["record_low"], compared["record_high"]) == pytest.approx((3.5, 98.5))
    assert compared["quantile"] == 0.5
    assert not compared["missed_by_factor_2"]
    assert compare_number(records, 25.0)["missed_by_factor_2"]
    for published, agrees in ((51.0, "yes"), (100.0, "no")):
        row = SimpleNamespace(published=published, **compare_number(records, published))
        assert lies_within_records(row) == agrees
    nothing = SimpleNamespace(published=1.0, **compare_number(None, 1.0))
    assert lies_within_records(nothing) == MISSING
    assert nothing.missed_by_factor_2 is False
