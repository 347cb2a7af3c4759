"""Refuses a grid that is too large to be planned, before it is planned."""

from __future__ import annotations

from owtsweep.config import require

#: Most blocks of a plan: each block is a file, and planning it takes some 0.1 ms.
MOST_BLOCKS = 100_000


def check_blocks(blocks: int) -> None:
    """Raise `InputError` if a sweep would have more than `MOST_BLOCKS` blocks.

    A study calls it when its configuration is checked. (The hub has bounds of its own.)
    """
    require(
        blocks <= MOST_BLOCKS,
        f"grid: a sweep would have {blocks:.3g} blocks of work, more than {MOST_BLOCKS:.0e}; give "
        "fewer values, schemes or replicates",
    )
