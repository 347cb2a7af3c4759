"""Lists the figures of a run: those of each tuning, and those of several tunings together."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from owtsweep.figures.drawings import Drawing
from owtsweep.sweep.study import Engine, Joint

if TYPE_CHECKING:
    from owtsweep.sweep.results import Results


def list_drawings(
    engine: Engine, results: Mapping[str, Results], metadata: Mapping[str, str]
) -> dict[str, Drawing]:
    """Return figure name -> function that draws the figure.

    With several tunings, figures that show them together come first, and the name of a figure of
    one tuning ends with the tuning's name. A figure that does not depend on the tuning is listed
    once, without a tuning's name.

    Parameters
    ----------
    results
        The results by tuning; the name is "" in a run of one tuning.
    metadata
        Texts to store in the figures' files.
    """
    untuned: frozenset[str] = frozenset()
    listed: dict[str, Drawing] = {}
    if "" not in results and isinstance(engine, Joint):
        untuned = engine.untuned
        listed |= engine.joint_drawings(results, metadata)
    for tuning, result in results.items():
        drawings = engine.drawings(result.config, result.tables, result.rows, metadata)
        for name, drawing in drawings.items():
            shared = tuning == "" or name in untuned
            listed.setdefault(name if shared else f"{name}_{tuning}", drawing)
    return listed


def name_overview(engine: Engine, results: Mapping[str, Results]) -> str:
    """Return the name, in `list_drawings`, of the figure of the main result."""
    if "" not in results and isinstance(engine, Joint):
        return next(iter(engine.joint_drawings(results, {})))
    tuning, result = next(iter(results.items()))
    name = engine.overview(result.config)
    return f"{name}_{tuning}" if tuning else name
