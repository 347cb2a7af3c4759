"""Holm's step-down procedure as its definition says it, for tests of what uses it."""

from __future__ import annotations


def naive_holm(p_values: list[float], level: float) -> list[bool]:
    rejected = [False] * len(p_values)
    left = dict(enumerate(p_values))
    while left:
        smallest = min(left, key=left.__getitem__)
        if left.pop(smallest) > level / (len(left) + 1):
            break
        rejected[smallest] = True
    return rejected
