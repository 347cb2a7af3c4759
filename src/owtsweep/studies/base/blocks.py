"""Plans and runs the blocks of a study: some records of one cell and scheme each."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from itertools import product
from math import prod
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from owtsweep.errors import as_text
from owtsweep.results.status import FAILED, UNABLE
from owtsweep.studies.base.axes import Cell, list_cells
from owtsweep.studies.base.contest import C, Contest, ContestConfig
from owtsweep.studies.base.contract import NotFinite, Ready, Unable
from owtsweep.studies.base.declaration import AnyDeclaration, AnyPart
from owtsweep.studies.base.schemes import AnyScheme
from owtsweep.studies.base.tables import Judgement, make_rows
from owtsweep.sweep.study import Block

if TYPE_CHECKING:
    import pandas as pd


class Planned(NamedTuple):
    """What a plan must know of a scheme.

    Attributes
    ----------
    name
        The scheme's name.
    ignored
        The axes on which its estimates do not depend.
    code
        What of a user's code its rows depend on.
    anew
        Why stored rows must be computed anew; "" if they can be used.
    """

    name: str
    ignored: Sequence[str] = ()
    code: Mapping[str, object] = MappingProxyType({})
    anew: str = ""


def plan(
    declaration: AnyDeclaration,
    config: ContestConfig,
    cells: Sequence[Cell] | None = None,
    replicates: int | None = None,
) -> list[Block]:
    """Return all blocks of a configuration, or of some cells with another number of records.

    Parameters
    ----------
    cells
        Cells of the grid; None: all.
    replicates
        Number of records of each of these cells; None: that of the grid.

    Raises
    ------
    InputError
        If no scheme can serve the configuration.
    """
    declaration.require(config)
    schemes = [
        Planned(
            scheme.name,
            find_ignored(declaration, scheme),
            declaration.schemes.describe_code(entry, scheme),
            declaration.schemes.explain_anew(scheme),
        )
        for entry, scheme in zip(
            config.schemes, declaration.schemes.resolve_all(config.schemes), strict=True
        )
    ]
    truth = declaration.shared == "truth"
    places = ("world",) if truth else ("world", "sensors")
    return plan_blocks(
        declaration.contest,
        config,
        schemes,
        declaration.list_content(config),
        declaration.most_records(config),
        _find_axes(declaration.contest, places),
        cells,
        replicates,
    )


def plan_blocks(
    contest: Contest[C],
    config: C,
    schemes: Sequence[Planned],
    shared: Mapping[str, object],
    most: int,
    grouping: Sequence[str],
    cells: Sequence[Cell] | None = None,
    replicates: int | None = None,
) -> list[Block]:
    """Return all blocks of a configuration: one per cell, scheme, and some records.

    A scheme has one block for all values of the axes that it ignores. Blocks begin at the multiples
    of `most`, so more records of a cell add blocks, and leave the full ones as they are.

    Parameters
    ----------
    contest
        The axes.
    config, schemes
        The configuration and its schemes.
    shared
        What the rows of every block depend on.
    most
        Most records of a block.
    grouping
        The axes that tell groups apart: on these depends what is made once for a group.
    cells, replicates
        Cells, and the number of records of each; None: those of the grid.
    """
    axes = contest.axes
    cells = list_cells(axes, config.grid) if cells is None else cells
    count = config.grid.replicates if replicates is None else replicates
    blocks: dict[tuple[object, ...], Block] = {}
    for cell, first in product(cells, range(0, count, most)):
        last = min(first + most, count)
        numbers = f"replicate{f's {first}-{last - 1}' if last - first > 1 else f' {first}'}"
        group = ", ".join([*_tell(cell, grouping), numbers])
        for scheme in schemes:
            known = {axis: cell.get(axis) for axis in axes if axis not in scheme.ignored}
            case = {"replicates": [first, last], "scheme": scheme.name}
            label = ", ".join([scheme.name, *_tell(known, contest.find_axes(config)), numbers])
            every = prod(len(getattr(config.grid, axis)) for axis in scheme.ignored)
            blocks.setdefault(
                (scheme.name, first, *known.values()),
                Block(
                    group,
                    label,
                    {**shared, **known, **case, **scheme.code},
                    every * (last - first),
                    every,
                    scheme.anew,
                ),
            )
    return list(blocks.values())


def find_ignored(declaration: AnyDeclaration, scheme: AnyScheme) -> list[str]:
    """Return the axes of what schemes are told on which the estimates of this one do not depend."""
    told = _find_axes(declaration.contest, ("knowledge",))
    return [axis for axis in declaration.schemes.list_ignored(scheme) if axis in told]


def run(
    declaration: AnyDeclaration, config: ContestConfig, blocks: Sequence[Block]
) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Run blocks of one group; yield each with its rows.

    Truth and measurements are made once for all schemes and tunings. An error of a user's scheme
    is the reason of its failed rows, and stops no other.
    """
    axes = declaration.contest.axes
    replicates = range(*blocks[0].content["replicates"])
    made = Records(declaration, config, replicates)
    for block in blocks:
        cell = {axis: value for axis in axes if (value := block.content.get(axis)) is not None}
        chosen = block.choose(config)
        entry = block.content.get("entry")
        scheme = Readied(declaration.schemes.resolve(entry or block.content["scheme"]))
        judged = [
            _judge(declaration, chosen, cell, record, parts, scheme, own=entry is None)
            for record, parts in made.take(chosen, cell)
        ]
        yield block, make_rows(block.content["scheme"], cell, axes, replicates, judged)


class Readied:
    """A scheme that is prepared once for all records about which it is told the same."""

    def __init__(self, scheme: AnyScheme) -> None:
        self._scheme = scheme
        self._made: dict[Hashable, Ready[object, object] | Unable] = {}

    def run(self, part: AnyPart) -> object:
        """Estimate from one part of a record.

        Raises
        ------
        Unable
            If the scheme cannot work with what it is told.
        """
        made = self._made.get(part.known)
        if made is None:
            try:
                made = self._scheme.prepare(part.known)
            except Unable as reason:
                made = reason
            self._made[part.known] = made
        if isinstance(made, Unable):
            raise made
        return made.run(part.measured)


class Records:
    """Some records of a group, whose truth, measurements and knowledge are made once each."""

    def __init__(
        self, declaration: AnyDeclaration, config: ContestConfig, replicates: Sequence[int]
    ) -> None:
        self._declaration, self._config, self._replicates = declaration, config, replicates
        self._truths: dict[Hashable, list[object]] = {}
        self._records: dict[Hashable, list[object]] = {}
        self._parts: dict[Hashable, list[Mapping[str, AnyPart]]] = {}

    def take(self, config: ContestConfig, cell: Cell) -> list[tuple[object, Mapping[str, AnyPart]]]:
        """Return each record of a cell, and its parts as the tuning of a configuration has them."""
        made, given = self._declaration, self._config
        world = self._identify(cell, ("world",))
        if world not in self._truths:
            self._truths = {world: [made.make_truth(given, cell, n) for n in self._replicates]}
        sensed = self._identify(cell, ("world", "sensors"))
        if sensed not in self._records:
            truths = self._truths[world]
            self._records = {sensed: [made.measure(given, cell, truth) for truth in truths]}
            self._parts = {}
        told = (config.tuning_name, *cell.items())
        records = self._records[sensed]
        if told not in self._parts:
            self._parts[told] = [made.inform(config, cell, record) for record in records]
        return list(zip(records, self._parts[told], strict=True))

    def _identify(self, cell: Cell, places: Sequence[str]) -> tuple[float | None, ...]:
        return tuple(cell.get(axis) for axis in _find_axes(self._declaration.contest, places))


def check_estimates(declaration: AnyDeclaration, estimates: object, samples: int) -> None:
    """Check that estimates have the fields that the study declares, of the declared shapes.

    Raises
    ------
    NotFinite
        If they do not; the message names the field.
    """
    try:
        values = {name: getattr(estimates, name) for name in declaration.estimates}
    except AttributeError as error:
        raise NotFinite(f"the estimates lack {error.name}") from None
    for name, field in declaration.estimates.items():
        value = values[name]
        if value is None and field.optional:
            continue
        if value is None:
            raise NotFinite(f"the estimates lack {name}")
        shape, wanted = np.shape(value), (samples, *field.shape)
        if len(shape) != len(wanted) or any(
            size not in (-1, found) for found, size in zip(shape, wanted, strict=True)
        ):
            told = ", ".join("any" if size == -1 else str(size) for size in wanted)
            raise NotFinite(f"{name} has the shape {shape}, not ({told})")


def _judge(
    declaration: AnyDeclaration,
    config: ContestConfig,
    cell: Cell,
    record: object,
    parts: Mapping[str, AnyPart],
    scheme: Readied,
    *,
    own: bool,
) -> Judgement:
    """Run a scheme on a record and compare its estimates with the truth."""
    try:
        estimates = {name: scheme.run(part) for name, part in parts.items()}
        if not own:
            for given in estimates.values():
                check_estimates(declaration, given, declaration.count_samples(record))
        return Judgement(declaration.score(config, cell, record, parts, estimates))
    except Unable as reason:
        return Judgement.none(UNABLE, str(reason))
    except NotFinite as reason:
        return Judgement.none(FAILED, str(reason))
    except (Exception, SystemExit) as error:
        if own:
            raise
        return Judgement.none(FAILED, as_text(error))


def _find_axes(contest: Contest[C], places: Sequence[str]) -> list[str]:
    """Return the axes that enter at some of the places "world", "sensors" and "knowledge"."""
    return [axis.name for axis in contest.conditions if axis.enters in places]


def _tell(cell: Mapping[str, float | None], axes: Sequence[str]) -> list[str]:
    """Return in words where a cell is along some axes."""
    return [f"{axis} {value:g}" for axis in axes if (value := cell.get(axis)) is not None]
