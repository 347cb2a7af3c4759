"""The hub study as a declaration, from motion to schemes' errors, and the engines that run it."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.config import AnyConfig
from owtsweep.errors import InputError
from owtsweep.evaluation.estimate import Reading
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.figures.drawings import Drawing, save_figure
from owtsweep.results.answer import tell_alike, tell_answer, tell_beaten
from owtsweep.results.best_scheme import find_best_schemes
from owtsweep.results.conditions import Value
from owtsweep.results.contents import Contents
from owtsweep.results.cube import Cube
from owtsweep.results.ratios import compare_with_best
from owtsweep.results.regret import Judged, make_regret, tell_regret
from owtsweep.results.summary import summarise
from owtsweep.results.verdicts import make_table
from owtsweep.studies.base.blocks import DeclaredBlocks
from owtsweep.studies.base.contest import count_records
from owtsweep.studies.base.declaration import (
    AnyDeclaration,
    Batch,
    Declaration,
    Means,
    Quantity,
    Shown,
    Stated,
)
from owtsweep.studies.base.looks import plan_look
from owtsweep.studies.base.schemes import NotFinite, Part
from owtsweep.studies.hub.batch import backend, know, run_batch, uses_kernels
from owtsweep.studies.hub.checks import count_table_bytes
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import (
    REGISTERED,
    SCHEMES,
    Known,
    Scheme,
    list_baselines,
    resolve_all,
    scheme_names,
)
from owtsweep.studies.hub.describe import (
    ask,
    find_winners,
    judge_efficiency,
    list_origin,
    list_origin_lines,
    make_cube,
    quote_worlds,
    tell_not_asked,
    tell_window,
)
from owtsweep.studies.hub.expected import answers, drawing, engine
from owtsweep.studies.hub.figures import listing
from owtsweep.studies.hub.measures import JUDGED, criteria, from_trajectories
from owtsweep.studies.hub.records import (
    REPLICATES_PER_BLOCK,
    Records,
    count_records_per_block,
    make_records_at,
)
from owtsweep.studies.hub.sensors import Measured, observe
from owtsweep.studies.hub.worlds import (
    BOUNDARY,
    FRICTION_ANGLE,
    WORLDS,
    World,
    find_amplitude,
    find_world,
    list_content,
    list_maps,
    list_untold,
)
from owtsweep.sweep.gather import Results
from owtsweep.sweep.study import Block, Engine, Look, Square

if TYPE_CHECKING:
    from rich.console import RenderableType

    from owtsweep.comparing.comparison import Aspects, Candidate

Cell = Mapping[str, Value]
UNITS = {
    "position": "m, north and east",
    "velocity": "m/s, north and east",
    "specific_force": "m/s^2, in the frame of the IMU",
    "fixes": "m, north and east, of sensors.gnss.delay seconds before",
}


class Record(NamedTuple):
    """One record whose motion has no amplitude yet.

    truth: true x, y (m) and v_x, v_y (m/s), shape (steps, 4).
    motion, noise: the parts of the measurements that motion and noise contribute.
    """

    records: Records
    truth: Array
    motion: Measured
    noise: Measured


def _measure(config: HubConfig, cell: Cell, records: Records) -> Record:
    """Return what sensors say; fixes that are lost with the noise are lost with the motion."""
    (motion,), (noise,), direction = records.motion, records.noise, records.direction
    observed = observe(motion, direction, records.sensors)
    observed.fixes[np.isnan(noise.fixes)] = np.nan
    truth = [np.outer(series, direction) for series in (motion.position, motion.velocity)]
    return Record(records, np.concatenate(truth, axis=1), observed, noise)


def _inform(config: HubConfig, cell: Cell, record: Record) -> dict[str, Part[Known, Measured]]:
    """Return the whole record, or in a cell without an amplitude motion and noise apart."""
    known, motion, noise = know(config, cell), record.motion, record.noise
    if known.amplitude is None:
        return {"motion": Part(known, motion), "noise": Part(known, noise)}
    return {"whole": Part(known, motion.add_noise(known.amplitude, noise))}


def _score(
    config: HubConfig,
    cell: Cell,
    record: Record,
    parts: Mapping[str, Part[Known, Measured]],
    estimates: Mapping[str, Trajectory],
) -> Means:
    amplitude = find_amplitude(config, cell)
    settled = config.measures.find_settled(record.records.sensors.step)
    if amplitude is None:
        means = from_trajectories(estimates["motion"], estimates["noise"], record.truth, settled)
    else:
        truth, extremes = amplitude * record.truth, config.measures.extremes
        means = from_trajectories(None, estimates["whole"], truth, settled, extremes=extremes)
    if not np.all(np.isfinite(means.products)):
        raise NotFinite("squares of the errors are too large, or no numbers")
    return means


def superposes(config: HubConfig, scheme: Scheme) -> bool:
    """Return whether a scheme runs once for all amplitudes, motion and noise apart.

    A scheme with `knows_motion` does not, for it has other gains at each; nor does one with a
    kernel of its own.
    """
    alone = scheme.knows_motion or scheme.batched == "own"
    return config.evaluation == "superposed" and scheme.linear and not alone


def _show(config: HubConfig, cell: Cell, record: Record) -> Shown:
    (part,) = _inform(config, cell, record).values()
    step, measured = record.records.sensors.step, part.measured
    time = step * np.arange(len(record.truth))
    truth = (part.known.amplitude or 0.0) * record.truth
    of_fixes = time[:: record.records.sensors.fix_interval][: len(measured.fixes)]
    return Shown(
        time,
        config.measures.find_settled(step),
        {"position": truth[:, :2], "velocity": truth[:, 2:]},
        {
            "specific_force": Reading(time, measured.specific_force),
            "fixes": Reading(of_fixes, measured.fixes),
        },
        UNITS,
    )


def _state(record: Record, estimates: Mapping[str, Trajectory]) -> Stated:
    (found,) = estimates.values()
    P = found.covariance
    stated = {} if P is None else {"position": P[:, :2, :2], "velocity": P[:, 2:, 2:]}
    return Stated({"position": found.state[:, :2], "velocity": found.state[:, 2:]}, stated, 0.0)


def _declare(world: World) -> AnyDeclaration:
    return Declaration(
        axes=world,
        schemes=SCHEMES,
        list_content=list_content,
        most_records=count_records_per_block,
        make_truth=lambda config, cell, replicate: make_records_at(config, cell, [replicate]),
        measure=_measure,
        inform=_inform,
        tell=Scheme.tell,
        score=_score,
        estimates={"state": Quantity((4,)), "covariance": Quantity((4, 4), optional=True)},
        count_samples=lambda record: len(record.truth),
        show=_show,
        state=_state,
        superposes=superposes,
        batch=Batch(uses_kernels, make_records_at, run_batch),
        list_untold=list_untold,
    )


DECLARATIONS = {world.name: _declare(world) for world in WORLDS.values()}


def find_declaration(config: HubConfig) -> AnyDeclaration:
    """Return the declaration of the world that a configuration chooses."""
    return DECLARATIONS[config.motion.kind]


logger = logging.getLogger(__name__)


class _Engine(Engine):
    """The part that all engines of the study share: the columns of rows, and the map."""

    def __init__(self, world: World) -> None:
        self.world = world
        names = [name for name in world.names if name != FRICTION_ANGLE.name]
        #: Columns without which no table can be made.
        self.row_types: Mapping[str, type] = {
            **dict.fromkeys(("scheme", "measure", "window"), str),
            **dict.fromkeys((*names, "replicate", "n_samples"), float),
            **dict.fromkeys(("motion", "cross", "noise", "value"), Square),
        }

    def sort_columns(self) -> list[str]:
        return [*self.world.names, "scheme", "measure", "window", "replicate"]

    def terminal(self, config: HubConfig, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
        from owtsweep.figures.terminal import frame, grid

        criterion, window = config.measures.criterion, config.measures.window
        table, names, notes = find_winners(config, tables["best_scheme"], criterion, window)
        conditions = self.world.find_conditions(config)
        judged = JUDGED[criterion]
        shown = grid(
            table, names, conditions, criterion, window,
            quantity=judged.title, unit=judged.unit, notes=notes,
        )  # fmt: skip
        return frame(list_origin_lines(config), shown, self._tell(config, table, tables))

    def contents(
        self, config: HubConfig, tables: Mapping[str, pd.DataFrame], rows: pd.DataFrame
    ) -> Contents:
        asked, best = ask(config), tables["best_scheme"]
        won = [find_winners(config, best, name, asked.window) for name in asked.criteria]
        table, _, notes = won[0]
        return Contents(
            list_origin_lines(config),
            [*self._tell(config, table, tables), *notes],
            self.world.find_conditions(config),
            asked.criteria,
            asked.window,
            asked.contenders,
            asked.baselines,
            make_cube(config, rows, baselines=True),
            pd.concat([each.table for each in won], ignore_index=True),
        )

    def _tell(
        self, config: HubConfig, table: pd.DataFrame, tables: Mapping[str, pd.DataFrame]
    ) -> list[str]:
        """Return the answer in sentences; `table` has the cells of the map."""
        judged, ratios, lines = JUDGED[config.measures.criterion], tables["ratios"], []
        if len(table):
            lines += tell_answer(table, ratios, judged, self.world.find_conditions(config))
            further = [name for name in scheme_names(config) if name not in REGISTERED]
            lines += tell_beaten(further, table, ratios, judged)
            lines += tell_alike(further, tables["summary"], [*ask(config).criteria])
        lines += tell_regret(tables) or quote_worlds(config)
        lines += _tell_bound(config)
        lines += tell_not_asked(config)
        return [*lines, tell_window(config.measures.window, config.measures.settling_time)]

    def overview(self, config: HubConfig) -> str:
        """Return the name of the map, figure 18 of Ren et al. (2019)."""
        return listing.MAP

    untuned = listing.UNTUNED

    def joint_drawings(
        self, results: Mapping[str, Results], metadata: Mapping[str, str]
    ) -> dict[str, Drawing]:
        """List the figure that shows the maps of all tunings side by side."""
        from owtsweep.studies.hub.figures import maps_by_tuning

        config: AnyConfig = next(iter(results.values())).config
        return {
            f"{maps_by_tuning.NAME}{end}": save_figure(
                partial(maps_by_tuning.draw, results, at), metadata
            )
            for end, at in list_maps(config).items()
        }


#: Computing time in s for an IMU step of one record and one scheme, motion and noise included:
#: `results/reference/paper/manifest.json` has 8.98 s for 100 000 steps, 600 records, 4 schemes.
SECONDS_PER_STEP = 3.7e-8
#: Bytes: of the process, per record and step of a worker, and the most of a worker, which runs long
#: records in parts. `benchmarks/measured.json` has the peaks to which these numbers were fitted, to
#: within a fifth up to 2000 s; longer records need less than predicted.
PROCESS, PER_STEP, MOST_OF_WORKER = 300e6, 120, 200e6


class RecordsEngine(DeclaredBlocks, _Engine):
    """The engine for the keys engine=batch and engine=reference: runs schemes on records."""

    samples = True
    drawings = staticmethod(listing.drawings)

    def __init__(self, world: World) -> None:
        _Engine.__init__(self, world)
        DeclaredBlocks.__init__(self, DECLARATIONS[world.name])

    def spectra(self, config: HubConfig) -> pd.DataFrame | None:
        from owtsweep.studies.hub.figures import error_spectra, spectrum_tables

        if not self.world.has_spectrum:
            return None
        try:
            return spectrum_tables.curves(error_spectra.compute(config))
        except InputError:  # no scheme has one
            return None

    def backend(self, config: HubConfig) -> str:
        """Return "threading" if compiled kernels, which release the GIL, run all; else "loky".

        With engine=batch, log a warning for each scheme that its tuning leaves without a kernel.
        """
        for doubt in self.world.list_doubts(config):
            logger.warning(doubt)
        schemes = resolve_all(SCHEMES.list_entries(config), config)
        for scheme in schemes:
            if config.engine == "batch" and scheme.unbatched:
                logger.warning(
                    "%s: %s no kernel that serves all amplitudes; it runs step by step, amplitude "
                    "by amplitude",
                    scheme.name,
                    scheme.unbatched,
                )
        return backend(config, schemes)

    def predict(
        self, config: HubConfig, blocks: Sequence[Block], workers: int
    ) -> tuple[float, float] | None:
        """Return the computing time of blocks in s, without compilation, and the memory in bytes.

        None if a kernel does not run all schemes: the time of step-by-step runs differs by orders
        of magnitude from scheme to scheme.
        """
        parts = config.by_tuning().values()
        for part in parts:
            schemes = resolve_all(part.schemes, part)
            if not all(uses_kernels(part, scheme) for scheme in schemes):
                return None
        steps = config.record.duration * config.sensors.imu.rate
        records = sum(count_records(block) for block in blocks)
        moved = {block.group: count_records(block) for block in blocks}
        motion = self.world.seconds_per_step * steps * sum(moved.values())
        each = min(PER_STEP * steps * REPLICATES_PER_BLOCK, MOST_OF_WORKER)
        tables = sum(count_table_bytes(part) for part in parts)
        return motion + SECONDS_PER_STEP * steps * records, PROCESS + workers * each + tables

    def plan_look(self, config: HubConfig, rows: pd.DataFrame) -> Look | None:
        """Return the next look; None if all cells are decided or have most records."""
        if not config.grid.decides:
            return None
        cube, cells = make_cube(config, rows, baselines=True), self.declaration.axes
        return plan_look(
            partial(self.plan, config), cells.list_cells(config), cube, rows, ask(config)
        )

    def tables(self, config: HubConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        cube = make_cube(config, rows, baselines=True)
        summary = summarise(cube)
        if config.grid.decides:
            best = make_table(cube, rows, ask(config))
        else:
            judged = {name: JUDGED[name] for name in criteria(config)}
            window, baselines = config.measures.window, list_baselines(config)
            best = find_best_schemes(cube, window, judged, baselines)
        ratios = compare_with_best(cube, best, JUDGED)
        summary = judge_efficiency(summary, config)
        return {"summary": summary, "best_scheme": best, "ratios": ratios}

    def make_regret(
        self, config: HubConfig, rows: Mapping[str, pd.DataFrame]
    ) -> dict[str, pd.DataFrame]:
        name = config.measures.criterion
        judged = Judged(name, JUDGED[name], config.measures.window)
        cubes = {w: make_cube(config, part, baselines=True) for w, part in rows.items()}
        return make_regret(cubes, config.over or {}, judged, self.tell_worlds(config))


class ExpectedEngine(_Engine):
    """The engine for the key engine=expected: computes schemes' expected errors without records."""

    samples = False
    plan = staticmethod(engine.plan)
    run = staticmethod(engine.run)
    drawings = staticmethod(drawing.drawings)

    def tables(self, config: HubConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
        tables = answers.tables(config, rows)
        return {**tables, "summary": judge_efficiency(tables["summary"], config)}

    def backend(self, config: HubConfig) -> str:
        """Return "threading": nearly all the time is spent in kernels, which release the GIL."""
        return "threading"


def _tell_bound(config: HubConfig) -> list[str]:
    """Return a sentence on the least error without knowledge of the motion, if it is known."""
    from owtsweep.studies.hub.bounds.kalman import kalman_bound

    if config.measures.window != "settled" or config.sensors.imu.high_pass is not None:
        return []
    try:
        bound = kalman_bound(config)
    except InputError:  # numbers too far apart to compute with
        return []
    judged = JUDGED[config.measures.criterion]
    return [
        "Bound: an estimator that assumes nothing of the motion has on average at least "
        f"{judged.show(float(judged.express(bound)))}. Less takes knowledge of the motion, which "
        "SKFA learns (measures.efficiency=true), or chance."
    ]


def make_engine(config: HubConfig) -> Engine:
    """Return the engine for the key `engine`: batch and reference run schemes on records."""
    kind = ExpectedEngine if config.engine == "expected" else RecordsEngine
    return kind(find_world(config))


def describe_run(run: Candidate) -> Aspects:
    """Describe a run of the hub study, and what two runs must share so that records are paired."""
    from owtsweep.comparing.comparison import Aspects

    config: HubConfig = run.config
    window, world = config.measures.window, find_world(config)
    # sigma, delay, rate, bias and tuning change neither the motion's phases nor the draws of noise
    pairing = {"seed": config.seed, "record": config.record, **world.list_pairing(config)}
    return Aspects(
        conditions=world.conditions,
        grid=world.get_grid(config),
        schemes=scheme_names(config),
        criterion=config.measures.criterion,
        window=window,
        pairing=pairing,
        boundary=BOUNDARY if world.has_spectrum else None,
        origin=list_origin(config),
        beside=list_baselines(config),
        best_of=None
        if config.engine != "expected"
        else lambda rows, grid, schemes, criterion: answers.best_scheme(
            Cube.of_rows(rows, schemes, world.conditions, grid), [criterion], window
        ),
    )
