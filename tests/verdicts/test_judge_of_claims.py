"""Claims that are data: each kind by brute force, what is missing, and files that are refused."""

from __future__ import annotations

from itertools import product

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from owtsweep.errors import InputError
from owtsweep.verdicts.claims_file import KINDS, OF, read_claims
from owtsweep.verdicts.inference import MISSING, NOT_REPRODUCED, REPRODUCED, UNDECIDED
from owtsweep.verdicts.judge import KINDS as FUNCTIONS
from owtsweep.verdicts.judge import OF as TRANSFORMS
from owtsweep.verdicts.judge import find_best, judge, list_beyond
from owtsweep.verdicts.score_table import ScoreTable

RECORDS = 6
SCHEMES, SEAS, SIZES = ("A", "B", "C"), ("calm", "rough"), (0.1, 0.3, 1.0)


@pytest.fixture(scope="module")
def table() -> ScoreTable:
    """Three schemes in two seas at three sizes: C is worse than B, and B than A."""
    rng = np.random.default_rng(2)
    rows = [
        (scheme, sea, size, "error", replicate, place * size * (1.0 + 0.05 * rng.normal()))
        for (place, scheme), sea, size, replicate in product(
            enumerate(SCHEMES, 1), SEAS, SIZES, range(RECORDS)
        )
    ]
    columns = ["scheme", "sea", "size", "measure", "replicate", "value"]
    shuffled = pd.DataFrame(rows, columns=columns).sample(frac=1.0, random_state=1)
    return ScoreTable(shuffled)


def judge_claim(tmp_path, tables, body: str, head: str = ""):
    path = tmp_path / "claims.toml"
    path.write_text(
        f'{head}\n[[statements]]\nname = "F1"\ntext = "t"\nprinted = "p"\ndefinition = "d"\n'
        f'[[statements.claims]]\ntext = "c"\nreason = "r"\n{body}',
        encoding="utf-8",
    )
    read = read_claims(path)
    (judged,) = judge(read.statements, tables, read)
    (claim,) = judged.claims
    return claim


def values_of(table: ScoreTable, scheme: str, sea: str, size: float) -> np.ndarray:
    rows = table.table
    chosen = (rows["scheme"] == scheme) & (rows["sea"] == sea) & (rows["size"] == size)
    return rows[chosen].sort_values("replicate")["value"].to_numpy()


def interval(values: np.ndarray) -> tuple[float, float]:
    return stats.t.interval(0.95, len(values) - 1, values.mean(), stats.sem(values))


def test_every_kind_and_transform_has_a_function():
    assert set(FUNCTIONS) | {"not_judged"} == set(KINDS)
    assert tuple(TRANSFORMS) == OF


@pytest.mark.parametrize(
    ("of", "made"),
    [
        ('"identity"', lambda v: v),
        ('["one_minus", "positive_part"]', lambda v: np.maximum(1.0 - v, 0.0)),
        ('["one_minus", "abs"]', lambda v: np.abs(v - 1.0)),
        ('"inverse"', lambda v: 1.0 / v),
    ],
)
def test_bounds_are_of_what_is_made_of_the_values(tmp_path, table, of, made):
    body = (
        'kind = "bound"\nselect = { sea = ["calm", "rough"], scheme = "B", size = 0.3 }\n'
        f'of = {of}\nside = "below"\nbound = 0.5'
    )
    claim = judge_claim(tmp_path, [table], body)
    assert [d.label for d in claim.decisions] == ["calm, B, 0.3", "rough, B, 0.3"]
    for decision, sea in zip(claim.decisions, SEAS, strict=True):
        values = made(values_of(table, "B", sea, 0.3))
        assert decision.value == pytest.approx(values.mean())
        assert (decision.low, decision.high) == pytest.approx(interval(values))
        assert decision.p == pytest.approx(stats.ttest_1samp(values, 0.5).pvalue)
        assert decision.t == pytest.approx(-stats.ttest_1samp(values, 0.5).statistic)


def test_ratios_are_taken_in_each_record_or_of_the_means(tmp_path, table):
    fields = (
        'select = { scheme = "B", sea = "calm", size = [0.1, 1.0] }\nagainst = { scheme = "A" }\n'
        'label = "$sea, $size m"\nside = "above"\nbound = 1.0'
    )
    each = judge_claim(tmp_path, [table], f'kind = "ratio"\n{fields}')
    means = judge_claim(tmp_path, [table], f'kind = "ratio_of_means"\n{fields}')
    assert each.verdict == means.verdict == REPRODUCED
    for one, other, size in zip(each.decisions, means.decisions, (0.1, 1.0), strict=True):
        assert one.label == other.label == f"calm, {size:g} m: B / A"
        a, b = values_of(table, "B", "calm", size), values_of(table, "A", "calm", size)
        assert one.value == pytest.approx(np.mean(a / b))
        assert (one.low, one.high) == pytest.approx(interval(a / b))
        assert other.value == pytest.approx(a.mean() / b.mean())
        for end in (other.low, other.high):  # Fieller: what the paired test does not reject
            assert stats.ttest_rel(a, end * b).pvalue == pytest.approx(0.05)


def test_differences_have_a_sign_unless_it_is_taken_away(tmp_path, table):
    fields = (
        'kind = "difference"\nselect = { scheme = "A", sea = "calm", size = 0.3 }\n'
        'against = { scheme = "B" }\nside = "below"\nbound = 0.0\n'
    )
    apart = values_of(table, "A", "calm", 0.3) - values_of(table, "B", "calm", 0.3)
    (signed,) = judge_claim(tmp_path, [table], fields).decisions
    assert (signed.value, signed.low, signed.high) == pytest.approx(
        (apart.mean(), *interval(apart))
    )
    assert signed.t == pytest.approx(-stats.ttest_1samp(apart, 0.0).statistic)
    assert signed.label == "A, calm, 0.3 / B, calm, 0.3"
    (size,) = judge_claim(tmp_path, [table], f'{fields}of = "abs"').decisions
    assert size.value == pytest.approx(np.abs(apart).mean())


def test_the_best_of_others_is_found_in_each_place(tmp_path, table):
    body = (
        'kind = "against_best"\nselect = { scheme = "A", sea = ["calm", "rough"], size = 0.1 }\n'
        'against = { scheme = ["C", "B"] }\nlabel = "$sea"\nside = "below"\nbound = 1.0'
    )
    claim = judge_claim(tmp_path, [table], body)
    assert [d.label for d in claim.decisions] == ["calm: A / B", "rough: A / B"]
    a, b = values_of(table, "A", "rough", 0.1), values_of(table, "B", "rough", 0.1)
    assert claim.decisions[1].value == pytest.approx(a.mean() / b.mean())
    assert find_best([a, a, b], other_than=0) == 2  # what coincides is no rival
    assert find_best([a, a], other_than=0) is None
    assert find_best([b, a, a]) == 2  # the last of those that coincide


def test_several_are_compared_among_themselves(tmp_path, table):
    fields = 'select = { scheme = ["B", "A", "C"], sea = "calm", size = 0.3 }\n'
    fields += 'against = "scheme"\nlabel = "$sea"\n'
    equal = judge_claim(
        tmp_path, [table], f'kind = "nearly_equal"\n{fields}side = "above"\nbound = 0.8'
    )
    assert [d.label for d in equal.decisions] == ["calm: A / C"]
    assert equal.verdict == NOT_REPRODUCED
    spread = judge_claim(tmp_path, [table], f'kind = "spread"\n{fields}side = "below"\nbound = 4.0')
    told = [d.label.removeprefix("calm: ") for d in spread.decisions]
    assert told == ["B / A", "B / C", "A / B", "A / C", "C / B", "C / A"]
    assert spread.verdict == REPRODUCED
    grows = judge_claim(
        tmp_path, [table],
        'kind = "monotone"\nselect = { scheme = "A", sea = "rough", size = [0.1, 0.3, 1.0] }\n'
        'against = "size"\nlabel = "$sea"\nside = "above"\nbound = 1.0',
    )  # fmt: skip
    assert [d.label for d in grows.decisions] == ["rough: 0.3 / 0.1", "rough: 1 / 0.3"]
    assert grows.verdict == REPRODUCED


def test_a_number_that_is_known_exactly_decides_by_itself(tmp_path):
    record = ScoreTable(
        pd.DataFrame({"state": ["x", "y", "z"], "replicate": 0, "value": [0.9, 0.7, 0.8]})
    )
    body = 'kind = "bound"\nselect = { state = "*" }\nside = "below"\nbound = '
    assert judge_claim(tmp_path, [record], f"{body}0.85").verdict == UNDECIDED
    claim = judge_claim(tmp_path, [record], f"{body}0.85\nexact = true")
    assert claim.verdict == NOT_REPRODUCED
    assert claim.deciding.label == "x, one record"
    assert (claim.deciding.low, claim.deciding.high) == (0.9, 0.9)
    assert judge_claim(tmp_path, [record], f"{body}1.0\nexact = true").verdict == REPRODUCED


def test_only_records_that_have_all_count(tmp_path):
    rows = [("A", 0, 1.0), ("A", 1, 2.0), ("A", 2, 3.0), ("B", 1, 1.0), ("B", 2, 2.0)]
    some = ScoreTable(pd.DataFrame(rows, columns=["scheme", "replicate", "value"]))
    body = 'kind = "ratio"\nselect = { scheme = "A" }\nagainst = { scheme = "B" }\n'
    (found,) = judge_claim(tmp_path, [some], f'{body}side = "above"\nbound = 1.0').decisions
    assert found.value == (2.0 / 1.0 + 3.0 / 2.0) / 2.0


def test_what_the_scores_lack_is_missing_and_says_what(tmp_path, table):
    fields = 'side = "above"\nbound = 0.0\nlabel = "$sea, $size m"\n'
    body = f'kind = "bound"\n{fields}select = {{ scheme = "A", sea = "calm", size = [0.1, 7.0] }}'
    claim = judge_claim(tmp_path, [table], body)
    assert claim.verdict == MISSING
    assert claim.missing == ("calm, 7 m",)
    head = 'script = "experiments.mine"'
    other = f'kind = "bound"\n{fields}select = {{ scenario = "decay" }}'
    assert judge_claim(tmp_path, [table], other, head).missing == (
        "scores of python -m experiments.mine",
    )
    read = read_claims(tmp_path / "claims.toml")
    assert list_beyond(read.statements, [table]) == ["F1"]
    decay = ScoreTable(
        pd.DataFrame({"scenario": "decay", "replicate": [0, 1], "value": [1.0, 2.0]})
    )
    assert list_beyond(read.statements, [table, decay]) == []
    assert judge_claim(tmp_path, [table, decay], other).decisions[0].value == 1.5
    never = judge_claim(tmp_path, [table], 'kind = "not_judged"')
    assert (never.verdict, never.missing) == (MISSING, ("r",))
    nothing = f'kind = "bound"\n{fields}select = {{ scheme = "Z", sea = "*", size = 0.1 }}'
    assert judge_claim(tmp_path, [table], nothing).verdict == MISSING


def test_fields_are_inherited_and_the_innermost_counts(tmp_path, table):
    head = 'select = { sea = "calm", size = 0.1 }\nkind = "bound"\nside = "below"\nbound = 9.0'
    body = (
        'select = { scheme = "A" }\n'
        'parts = [{ bound = 1.0 }, { select = { sea = "rough" }, side = "above", bound = 0.0 }]'
    )
    claim = judge_claim(tmp_path, [table], body, head)
    told = [(d.label, d.side, d.threshold) for d in claim.decisions]
    assert told == [("calm, 0.1, A", "below", 1.0), ("rough, 0.1, A", "above", 0.0)]


def test_a_column_with_several_values_must_be_named(tmp_path, table):
    body = 'kind = "bound"\nselect = { scheme = "A", sea = "calm" }\nside = "above"\nbound = 0.0'
    with pytest.raises(InputError, match="size has several values"):
        judge_claim(tmp_path, [table], body)


GOOD = """
[[statements]]
name = "F1"
text = "t"
printed = "p"
definition = "d"
[[statements.claims]]
text = "c"
reason = "r"
kind = "bound"
select = { scheme = ["A", "B"] }
side = "below"
bound = 1.0
"""


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("kind", "king", "statement 1, claim 1: 'king' is not known; did you mean kind?"),
        ('"bound"', '"bond"', "kind: 'bond' is not known; did you mean bound?"),
        ("bound = 1.0", "bound = nan", "bound: nan is no number"),
        ("bound = 1.0", 'bound = "1"', "bound: '1' is no number"),
        ("bound = 1.0", "", "bound needs `select`, `side` and `bound`"),
        ('"below"', '"under"', "side: it must be 'below', 'above'"),
        ("reason", "of", "statement 1, claim 1: reason is missing; write"),
        ('reason = "r"', "", "claim 1: reason is missing"),
        ('["A", "B"]', "[]", "the list is empty"),
        ('["A", "B"]', "[[1]]", "[1] is no number"),
        ('"bound"', '"ratio"', "against: ratio needs columns with values"),
        ('"bound"', '"spread"\nagainst = "sea"', "against: 'sea' is not in `select`"),
        ("select = ", "select = 3 #", "select: it must be a valid table"),
        ("[[statements]]", "[[statement]]", "'statement' is not known"),
        ("[[statements.claims]]", "[statements.claims]", "claims: it must be a valid list"),
        ("name", "= name", "this is no TOML"),
        ('"d"', "[" * 5000, "this is no TOML"),
        ('["A", "B"]', str(list(range(1000))) + ", n = " + str(list(range(101))), "101000 comp"),
        ("[[statements.claims]]", "[[goals]]", "statement 1: claims is missing"),
        (GOOD, "", "it has no statements"),
        (GOOD, f"#{'x' * 1_000_001}", "it is larger than 1 MB"),
    ],
)
def test_a_file_that_is_no_such_file_is_refused_in_one_line(tmp_path, old, new, told):
    path = tmp_path / "claims.toml"
    path.write_text(GOOD.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputError) as refused:
        read_claims(path)
    assert told in str(refused.value)
    assert str(refused.value).startswith(str(path))
    assert "\n" not in str(refused.value)


def test_a_good_file_is_read_and_no_file_is_refused(tmp_path):
    path = tmp_path / "claims.toml"
    path.write_text(GOOD, encoding="utf-8")
    assert read_claims(path).statements[0].claims[0].parts[0].select == {"scheme": ("A", "B")}
    for nothing in (tmp_path, tmp_path / "none.toml"):
        with pytest.raises(InputError):
            read_claims(nothing)
