"""Plans and runs the blocks of a study: some records of one cell and scheme each."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby, product
from math import prod
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from owtsweep.config import AnyConfig
from owtsweep.config.over import NOMINAL
from owtsweep.errors import InputError, as_text
from owtsweep.results.conditions import Value
from owtsweep.results.status import FAILED, OK, UNABLE
from owtsweep.results.superposition import PRODUCTS
from owtsweep.statistics.deciding import FIRST
from owtsweep.studies.base.axes import Axes, Cell, World, make_worlds
from owtsweep.studies.base.contest import WINDOW
from owtsweep.studies.base.declaration import AnyDeclaration, AnyPart, Batch, F, Judgement, Means
from owtsweep.studies.base.schemes import AnyScheme, NotFinite, Ready, Unable
from owtsweep.sweep.study import Block

if TYPE_CHECKING:
    import pandas as pd

#: Most records of a block in a first look at a single cell, so that several cores share them.
FEW = 2


class Planned(NamedTuple):
    """What a plan must know of a scheme.

    ignored: the axes whose values one run of the scheme serves.
    content: What its rows depend on, besides what the rows of all schemes do.
    recompute: Why stored rows must be recomputed; "" if they can be used.
    alone: whether its blocks form groups of their own, one per cell: its gains are dearer than the
        records.
    """

    name: str
    ignored: Sequence[str] = ()
    content: Mapping[str, object] = MappingProxyType({})
    recompute: str = ""
    alone: bool = False


class PlanPart(NamedTuple):
    """A part of what a configuration can plan.

    cells, records: Some cells, and number of records of each.
    holds: whether a scheme runs in a cell.
    """

    cells: Sequence[Cell]
    records: int
    holds: Callable[[str, Cell], bool] = lambda scheme, cell: True


def find_worlds(declaration: AnyDeclaration, config: AnyConfig) -> dict[str, World]:
    """Return name -> world of a configuration, the nominal one first, or alone without `over`."""
    if config.over is None:
        return {NOMINAL: World(config)}
    return make_worlds(declaration.axes, declaration.list_untold(config), config)


def _list_content(
    declaration: AnyDeclaration, config: AnyConfig, world: World
) -> Mapping[str, object]:
    """Return what the rows of every block of a world depend on: as told, and what departs from it.

    So a world that does not depart has the blocks of a run without others.
    """
    told = declaration.list_content(config)
    if world.config is config:
        return told
    given = declaration.list_content(world.config)
    departed = {key: value for key, value in given.items() if told.get(key) != value}
    departed |= world.moved
    return {**told, "truth": departed} if departed else told


def _name_world(block: Block, world: str) -> Block:
    group, label = block.group, block.label
    if world != NOMINAL:
        group, label = f"{world}, {group}", f"{label}, {world}"
    return replace(block, group=group, label=label, worlds=(world,))


def plan_blocks(
    axes: Axes[Any],
    config: AnyConfig,
    schemes: Sequence[Planned],
    shared: Mapping[str, object],
    most: int,
    grouping: Sequence[str],
    part: PlanPart | None = None,
) -> list[Block]:
    """Return all blocks of a configuration, or those of a part of its cells and schemes.

    A scheme has one block for all values of the axes that it ignores. Blocks begin at the multiples
    of `most`, so more records of a cell add blocks, and leave the full ones as they are. Where
    cells get records until they are decided, the blocks are those of the first look, and no block
    is in two looks.

    shared: What the rows of every block depend on.
    most: Most records of a block.
    grouping: the axes that tell groups apart: on these depends what is made once for a group.
    """
    values, named = axes.get_values(config), axes.find_axes(config)
    cells = axes.list_cells(config)
    part = part or PlanPart(cells, config.grid.first)
    if config.grid.first <= FIRST and len(cells) == 1:
        most = min(most, FEW)
    if config.grid.decides:
        most = 1 << (min(most, FIRST).bit_length() - 1)  # it divides the records of each look
    # made once per scheme: blocks share them, so that a large plan fits into memory
    contents = [{**shared, "scheme": scheme.name, **scheme.content} for scheme in schemes]
    every = [prod(len(values[axis] or [None]) for axis in each.ignored) for each in schemes]
    blocks: dict[tuple[object, ...], Block] = {}
    for cell, first in product(part.cells, range(0, part.records, most)):
        last = min(first + most, part.records)
        numbers = f"replicate{f's {first}-{last - 1}' if last - first > 1 else f' {first}'}"
        group = ", ".join([*axes.tell(cell, grouping), numbers])
        for scheme, content, cases in zip(schemes, contents, every, strict=True):
            known = {axis: cell.get(axis) for axis in axes.names if axis not in scheme.ignored}
            key = (scheme.name, first, *known.values())
            if key in blocks or not part.holds(scheme.name, cell):
                continue
            lines = [scheme.name, *axes.tell(known, named)]
            blocks[key] = Block(
                ", ".join(lines) if scheme.alone else group,
                ", ".join([*lines, numbers]),
                {**content, **known, "replicates": [first, last]},
                cases * (last - first),
                cases,
                scheme.recompute,
            )
    return list(blocks.values())


def find_ignored(declaration: AnyDeclaration, scheme: AnyScheme) -> list[str]:
    """Return the axes of knowledge on which the estimates of a scheme do not depend."""
    entering = declaration.axes.find_entering("knowledge")
    return [axis for axis in scheme.ignores if axis in entering]


def _run_one_tuning(
    declaration: AnyDeclaration, blocks: Sequence[Block], records: Records, config: AnyConfig
) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Run blocks of some records and one tuning; yield each with its rows.

    Schemes that have kernels run together, with the first of their blocks of a cell.
    """
    config, axes, batch = blocks[0].choose(config), declaration.axes, declaration.batch
    by_name = {scheme.name: scheme for scheme in declaration.schemes.choose(config)}
    schemes = [by_name[block.content["scheme"]] for block in blocks]
    cells = [_find_cell(axes, block) for block in blocks]
    both = config, records.world.config
    batched = [
        batch is not None and all(batch.serves(each, scheme) for each in both) for scheme in schemes
    ]
    ready: dict[int, list[Judgement[Any]] | Exception] = {}
    for number, (block, scheme, cell) in enumerate(zip(blocks, schemes, cells, strict=True)):
        if batch is not None and batched[number] and number not in ready:
            together = [n for n in range(number, len(blocks)) if batched[n] and cells[n] == cell]
            chosen = [schemes[n] for n in together]
            found = batch.run(config, cell, records.gather(cell, batch), chosen)
            ready.update(zip(together, found, strict=True))
        if number in ready:
            judged = ready.pop(number)
            if isinstance(judged, Exception):
                raise judged
        else:
            readied = Readied(declaration, scheme)
            judged = [
                readied.judge(config, cell, record, parts)
                for record, parts in records.take(config, cell)
            ]
        labels = Labels(scheme.name, cell, axes.names, records.replicates)
        if declaration.superposes is None:
            yield block, make_rows(labels, judged)
        else:
            apart = not {*axes.find_entering("scale")} <= {*cell}
            yield block, make_product_rows(labels, judged, apart=apart)


def _find_cell(axes: Axes[Any], block: Block) -> Cell:
    content = block.content
    return {axis: value for axis in axes.names if (value := content.get(axis)) is not None}


class Readied:
    """A scheme that is prepared once for all records with the same knowledge."""

    def __init__(self, declaration: AnyDeclaration, scheme: AnyScheme) -> None:
        self.declaration, self.scheme = declaration, scheme
        self._made: dict[Hashable, Ready[object, object] | Unable] = {}

    def run(self, part: AnyPart) -> object:
        """Estimate from one part of a record; raise `Unable` if the scheme cannot work with it."""
        known = self.declaration.tell(self.scheme, part.known)
        if known not in self._made:
            try:
                self._made[known] = self.scheme.prepare(known)
            except Unable as reason:
                self._made[known] = reason
        made = self._made[known]
        if isinstance(made, Unable):
            raise made
        return made.run(part.measured)

    def judge(
        self, config: AnyConfig, cell: Cell, record: object, parts: Mapping[str, AnyPart]
    ) -> Judgement[Any]:
        """Run the scheme on the parts of a record, and judge its estimates."""
        declaration = self.declaration
        try:
            estimates = {name: self.run(part) for name, part in parts.items()}
            for given in estimates.values():
                check_estimates(declaration, given, declaration.count_samples(record))
            return Judgement(declaration.score(config, cell, record, parts, estimates))
        except (KeyboardInterrupt, InputError):  # a wrong input fails the block
            raise
        except BaseException as error:  # a user's scheme may raise anything
            return explain(error)


class Records:
    """Some records of a group, whose truth, measurements and knowledge are made once each."""

    def __init__(
        self,
        declaration: AnyDeclaration,
        config: AnyConfig,
        replicates: Sequence[int],
        world: World | None = None,
    ) -> None:
        self.replicates, self.world = replicates, world or World(config)
        self._declaration = declaration
        self._truths: dict[Hashable, list[object]] = {}
        self._records: dict[Hashable, list[object]] = {}
        self._parts: dict[Hashable, list[Mapping[str, AnyPart]]] = {}
        self._gathered: dict[Hashable, object] = {}

    def take(self, config: AnyConfig, cell: Cell) -> list[tuple[object, Mapping[str, AnyPart]]]:
        """Return each record of a cell, and its parts as the tuning of a configuration has them."""
        made, given, place = self._declaration, self.world.config, self.world.place(cell)
        world = self._identify(cell, "world")
        if world not in self._truths:
            self._truths = {world: [made.make_truth(given, place, n) for n in self.replicates]}
        sensed = self._identify(cell, "world", "sensors")
        if sensed not in self._records:
            truths = self._truths[world]
            self._records = {sensed: [made.measure(given, place, truth) for truth in truths]}
            self._parts = {}
        key = (config.tuning_name, *cell.items())
        records = self._records[sensed]
        if key not in self._parts:
            # kept besides: those of a cell without the axes that some scheme ignores
            self._parts = dict([*self._parts.items()][-1:])
            self._parts[key] = [made.inform(config, cell, record) for record in records]
        return list(zip(records, self._parts[key], strict=True))

    def gather(self, cell: Cell, batch: Batch) -> object:
        """Return all records of a cell as the one object that the kernels of `batch` run on."""
        world = self._identify(cell, "world")
        if world not in self._gathered:
            given, place = self.world.config, self.world.place(cell)
            self._gathered = {world: batch.make_records(given, place, self.replicates)}
        return self._gathered[world]

    def _identify(self, cell: Cell, *places: str) -> tuple[float | None, ...]:
        return tuple(cell.get(axis) for axis in self._declaration.axes.find_entering(*places))


def check_estimates(declaration: AnyDeclaration, estimates: object, samples: int) -> None:
    """Raise `NotFinite`, naming the field, unless estimates have the declared shapes."""
    for name, field in declaration.estimates.items():
        value = getattr(estimates, name, None)
        if value is None and field.optional and hasattr(estimates, name):
            continue
        if value is None:
            raise NotFinite(f"the estimates lack {name}")
        shape, wanted = np.shape(value), (samples, *field.shape)
        if len(shape) != len(wanted) or any(
            size not in (-1, found) for found, size in zip(shape, wanted, strict=True)
        ):
            text = ", ".join("any" if size == -1 else str(size) for size in wanted)
            raise NotFinite(f"{name} has the shape {shape}, not ({text})")


def explain(error: BaseException) -> Judgement[Any]:
    """Return why there are no estimates, from what a scheme has raised."""
    if isinstance(error, Unable):
        return Judgement(None, UNABLE, str(error))
    return Judgement(None, FAILED, str(error) if isinstance(error, NotFinite) else as_text(error))


class Labels(NamedTuple):
    """What the rows of a block are of: a scheme, a cell, and some records by their numbers.

    `cell` has the values of axes on which the rows depend; `axes` are the names of all.
    """

    scheme: str
    cell: Mapping[str, Value]
    axes: Sequence[str]
    replicates: Sequence[int]


def make_rows(labels: Labels, judged: Sequence[Judgement[Mapping[str, float]]]) -> pd.DataFrame:
    """Return the rows of a block, one per record and measure; an axis that is not set is NaN."""
    found = [part.found or {"": np.nan} for part in judged]
    windows = [WINDOW if part.status == OK else "" for part in judged]
    counts = [len(each) for each in found]
    columns = {
        "measure": [name for each in found for name in each],
        "window": np.repeat(windows, counts),
        "value": [value for each in found for value in each.values()],
    }
    return _join(labels, judged, counts, columns)


def make_product_rows(
    labels: Labels, judged: Sequence[Judgement[Means]], *, apart: bool
) -> pd.DataFrame:
    """Return the rows of a block of products; parameters as for `make_rows`.

    If motion and noise were run `apart`, a row has the columns motion, cross and noise, and stands
    for all values of the axis that scales the motion. Otherwise it has a value.
    """
    nothing = Means([""], [""], np.full((1, 3), np.nan), [0])
    found = [part.found or nothing for part in judged]
    products = np.concatenate([each.products for each in found]).T
    none = np.full_like(products, np.nan)
    counts = [len(each.measures) for each in found]
    columns = {
        "measure": [name for each in found for name in each.measures],
        "window": [name for each in found for name in each.windows],
        **dict(zip(PRODUCTS, products if apart else none, strict=True)),
        "value": none[0] if apart else products[2],
        "n_samples": [count for each in found for count in each.n_samples],
    }
    return _join(labels, judged, counts, columns)


def _join(
    labels: Labels,
    judged: Sequence[Judgement[F]],
    counts: Sequence[int],
    columns: Mapping[str, object],
) -> pd.DataFrame:
    """Put labels before the columns of measures, and status and reason behind."""
    import pandas as pd

    values = {axis: labels.cell.get(axis, np.nan) for axis in labels.axes}
    return pd.DataFrame(
        {
            **{axis: v if isinstance(v, str) else float(v) for axis, v in values.items()},
            "scheme": labels.scheme,
            "replicate": np.repeat(labels.replicates, counts),
            **columns,
            "status": np.repeat([part.status for part in judged], counts),
            "reason": np.repeat([part.reason for part in judged], counts),
        }
    )


class DeclaredBlocks:
    """The part of an engine that follows from a declaration: plans and runs blocks."""

    def __init__(self, declaration: AnyDeclaration) -> None:
        self.declaration = declaration

    def plan(self, config: AnyConfig, part: PlanPart | None = None) -> list[Block]:
        """Return all blocks of a configuration, or those of a part of its cells and schemes.

        Raise `InputError` if no scheme can serve the configuration.
        """
        made, table = self.declaration, self.declaration.schemes
        made.require(config)
        schemes: list[Planned] = []
        for entry, scheme in zip(table.list_entries(config), table.choose(config), strict=True):
            ignored = find_ignored(made, scheme)
            if made.superposes is not None and made.superposes(config, scheme):
                ignored += made.axes.find_entering("scale")  # one run serves all their values
            own = table.describe_content(config, entry, scheme)
            recompute = table.explain_recompute(scheme)
            schemes.append(Planned(scheme.name, ignored, own, recompute, scheme.knows_motion))
        most = made.most_records(config)
        grouping = made.axes.find_entering(*made.shared)
        planned: list[Block] = []
        for name, world in find_worlds(made, config).items():
            content = _list_content(made, config, world)
            blocks = plan_blocks(made.axes, config, schemes, content, most, grouping, part)
            planned += (
                blocks if config.over is None else [_name_world(block, name) for block in blocks]
            )
        return planned

    def run(
        self, config: AnyConfig, blocks: Sequence[Block]
    ) -> Iterator[tuple[Block, pd.DataFrame]]:
        """Run blocks of one group; yield each with its rows.

        Truth and measurements are made once for all successive blocks of some records, of all
        tunings. What a scheme raises is the reason of its failed rows, and stops no other.
        """
        worlds = find_worlds(self.declaration, config)
        for numbers, of_records in groupby(blocks, lambda block: block.content["replicates"]):
            world = worlds[blocks[0].worlds[0] if blocks[0].worlds else NOMINAL]
            records = Records(self.declaration, config, range(*numbers), world)
            for _, of_tuning in groupby(of_records, lambda block: block.tunings[:1]):
                yield from _run_one_tuning(self.declaration, list(of_tuning), records, config)

    def tell_worlds(self, config: AnyConfig) -> dict[str, str]:
        """Return world -> what departs there, in words."""
        worlds = find_worlds(self.declaration, config)
        return {name: world.sentence for name, world in worlds.items()}

    def warm_up(self, config: AnyConfig) -> None:
        """Warn of what the configuration makes doubtful."""
        self.declaration.warn(config)
