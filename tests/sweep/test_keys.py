"""Keys: what must change them, and what must not."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from types import MappingProxyType

import pytest

from owtsweep.config import Compute, changed
from owtsweep.errors import InputError
from owtsweep.sweep.keys import block_key, run_folder, run_hash
from owtsweep.sweep.plan import count_cases, make_plan, make_tasks
from owtsweep.sweep.study import Block


def block(**content):
    return Block(group="g", label="l", content=content, cases=1)


def test_key_has_32_digits_and_is_the_same_in_another_process(study):
    key = block_key(study, block(level=0.1, scheme="A"))
    assert len(key) == 32
    code = (
        "from types import SimpleNamespace as S; from owtsweep.sweep.keys import block_key;"
        "print(block_key(S(name='dummy', schema_version=1, numerics_version=1),"
        "S(content={'scheme': 'A', 'level': 0.1}, label='')), end='')"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == key


def test_key_ignores_order_label_and_group(study):
    one = Block("g", "l", {"a": 1, "b": {"c": [1, 2], "d": None}}, 1)
    two = Block("h", "m", MappingProxyType({"b": {"d": None, "c": (1, 2)}, "a": 1}), 9)
    assert block_key(study, one) == block_key(study, two)


@pytest.mark.parametrize(
    "content",
    [
        {"level": 0.1 + 0.2, "scheme": "A"},
        {"level": 0.3, "scheme": "B"},
        {"level": 0.3, "scheme": "A", "more": None},
        {"level": [0.3], "scheme": "A"},
        {"level": "0.3", "scheme": "A"},
    ],
)
def test_key_changes_with_the_last_bit_of_the_content(study, content):
    assert block_key(study, block(**content)) != block_key(study, block(level=0.3, scheme="A"))


@pytest.mark.parametrize("field", ["schema_version", "numerics_version", "name"])
def test_key_changes_with_study_and_versions(study, field):
    other = replace(study, **{field: "other" if field == "name" else 2})
    assert block_key(study, block(a=1)) != block_key(other, block(a=1))


@pytest.mark.parametrize("value", [float("nan"), float("inf"), object(), {1, 2}])
def test_key_refuses_what_has_no_exact_form(study, value):
    with pytest.raises(InputError, match=r"^block l: its content cannot be hashed") as caught:
        block_key(study, block(a=value))
    assert "\n" not in str(caught.value)


def test_run_hash_ignores_grid_schemes_compute_results_and_name(config):
    base = run_hash(config())
    assert len(base) == 10
    assert run_hash(config(level=[9.0])) == base
    assert run_hash(config(schemes=["C"])) == base
    assert run_hash(config(results="elsewhere")) == base
    assert run_hash(config(name="x")) == base
    assert run_hash(changed(config(), compute=Compute(backend="loky", workers=7))) == base


def test_run_hash_heeds_everything_else(config):
    hashes = {
        run_hash(c)
        for c in (config(), config(seed=1), config(sigma=0.2), config(engine="reference"))
    }
    assert len(hashes) == 4


def test_run_folder_is_named_by_name_or_experiment_and_hash(config):
    unnamed = config(results="here", experiment="fig18")
    assert run_folder(unnamed).as_posix() == f"here/fig18-{run_hash(unnamed)}"
    assert run_folder(config(results="here", name="mine")).as_posix() == "here/mine"
    with pytest.raises(InputError, match=r"^experiment: '\.\./x'"):
        run_folder(config(experiment="../x"))


def test_plan_keeps_order_and_joins_equal_blocks(study, config):
    plan = make_plan(study, config(level=[2.0, 1.0, 2.0]))
    assert [b.label for b in plan.values()] == ["A2.0", "B2.0", "A1.0", "B1.0"]
    assert count_cases(plan) == 8
    assert [[b.label for b in task.values()] for task in make_tasks(plan)] == [
        ["A2.0", "B2.0"],
        ["A1.0", "B1.0"],
    ]


def test_empty_plan_is_refused(study, config):
    with pytest.raises(InputError, match=r"^grid: it holds no case"):
        make_plan(study, config(level=[]))
