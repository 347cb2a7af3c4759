"""Who is best, against a look at every cell by itself."""

from __future__ import annotations

import numpy as np

from owtsweep.statistics.contest import contest, find_alike, group_coinciding, rank


def test_rank_is_the_order_of_means_with_equals_as_one():
    means = np.array([[1.0, 3.0, 2.0, 5.0], [1.0, 2.0, 2.0, np.nan], [4.0, 1.0, 2.0, np.nan]])
    took_part = np.isfinite(means)
    alike = find_alike(means[..., np.newaxis], took_part, np.ones((4, 1), dtype=bool))
    ranking = rank(means, alike, took_part)
    assert ranking.best.tolist() == [1, 2, 2, 0]
    assert ranking.runner_up.tolist() == [2, 1, 1, -1]
    assert ranking.told_apart.tolist() == [True, True, False, False]
    assert ranking.like_best[:, 0].tolist() == [True, True, False]
    assert ranking.like_best[:, 3].tolist() == [True, False, False]


def test_equal_means_are_no_coincidence():
    values = np.array([[[1.0, 2.0]], [[2.0, 1.0]]])
    outcome = contest(values)
    assert (outcome.best[0], outcome.runner_up[0], outcome.p[0]) == (0, 1, 1.0)


def test_every_cell_is_decided_by_itself():
    random = np.random.default_rng(1)
    values = random.lognormal(size=(4, 50, 6))
    values[random.uniform(size=values.shape) < 0.1] = np.nan
    values[2] = values[3] * (1.0 + 1e-12)
    whole = contest(values)
    for cell in range(50):
        alone = contest(values[:, cell : cell + 1])
        for together, single in zip(whole, alone, strict=True):
            np.testing.assert_array_equal(together[cell : cell + 1], single)
    assert not np.any(whole.best[whole.judged] == 2)  # its equal comes later


def test_groups_hold_what_coincides_with_their_first_member():
    marks = [1, 2, 1, 3, 2]
    groups = group_coinciding("abcde", lambda i, j: marks[i] == marks[j])
    assert groups == [("a", "c"), ("b", "e")]
