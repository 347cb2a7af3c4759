"""Tells how many inclinometers are enough, and where: a sentence, a table, and their limits."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.io.terminal import start_table
from owtsweep.structures.bernoulli import NEAR
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contest import describe_truth
from owtsweep.studies.tower.contract import Kind
from owtsweep.studies.tower.placement import Choice, Criterion, PlacementCase

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table

#: Quantities that sensors may be chosen for -> name in `placement`, and unit.
QUANTITIES: dict[str, tuple[Criterion, str]] = {
    "stress": ("stress", "Pa"),
    "base_moment": ("moment", "N m"),
}
#: Numbers on the terminal are in MPa or MN m.
MEGA = 1e6
#: Sensors are enough if one more lowers the standard deviation by less than this share.
WORTH = 0.05
NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight")
KIND_NAMES: dict[Kind, str] = {
    "x": "displacement sensors",
    "theta": "inclinometers",
    "a": "accelerometers",
    "strain": "strain gauges",
}


@dataclass(frozen=True)
class PlacedSensors:
    """Inclinometers chosen one by one, an `owtsweep.sweep.study.Placed`.

    config: the configuration, with the structure as it was given, and the sensors that are there.
    case: the structure with its sensors to choose from.
    quantity: a name in `QUANTITIES`.
    spread: whether the accelerometers are spread over the height because the user names no sensors.
    choices: the sets of the smallest number of inclinometers with a finite error, of one more, ...
    further: the set with one more than the last of `choices`; None if no height is left.
    everywhere: Inclinometers at all heights to choose from.
    """

    config: TowerConfig
    case: PlacementCase
    quantity: str
    spread: bool
    choices: tuple[Choice, ...]
    further: Choice | None
    everywhere: Choice

    def table(self) -> pd.DataFrame:
        """Return a row for each number of inclinometers, in SI units and shares."""
        criterion, unit = QUANTITIES[self.quantity]
        stressed, rows = self.quantity == "stress", []
        for choice, better in zip(self.choices, [*self.choices[1:], self.further], strict=True):
            share = choice.error(criterion)
            scale = self.case.stress_scale[choice.weld] if stressed else self.case.moment_scale
            added = {*better.heights} - {*choice.heights} if better else {np.nan}
            rows.append(
                {
                    "inclinometers": len(choice.chosen),
                    "heights": " ".join(f"{height:.9g}" for height in choice.heights),
                    "quantity": self.quantity,
                    "standard_deviation": share * scale,
                    "unit": unit,
                    "share": share,
                    "weld": self.case.welds[choice.weld] if stressed else np.nan,
                    "next_height": added.pop(),
                    "next_lowers": self._gain(choice, better) if better else np.nan,
                }
            )
        return pd.DataFrame(rows)

    def answer(self) -> RenderableType:
        """Return the sentence that answers, the table, and what both rest on."""
        from rich.console import Group
        from rich.text import Text

        steps = self.table()
        # the first number of inclinometers at which no further one is worth it
        enough = int(max(np.flatnonzero(steps["next_lowers"] >= WORTH), default=-1)) + 1
        lines = [*self._tell_origin(), *self._tell_limits(enough)]
        rows = list(steps.itertuples())
        return Group(
            Text(self._tell_enough(rows, enough)), self._make_table(rows), *(Text(x) for x in lines)
        )

    def _gain(self, choice: Choice, better: Choice) -> float:
        """Return by which share another set lowers the standard deviation."""
        criterion = QUANTITIES[self.quantity][0]
        return 1.0 - better.error(criterion) / choice.error(criterion)

    def _name_quantity(self) -> str:
        if self.quantity == "stress":
            return "the stress at the worst weld"
        low = self.config.heights[0] - self.config.structure.mudline
        where = "base" if low == 0.0 else f"lower cut, {low:g} m above the ground"
        return f"the bending moment at the {where}"

    def _tell_enough(self, steps: Sequence[Any], enough: int) -> str:
        what = f"the standard deviation of the error of {self._name_quantity()}"
        step = steps[min(enough, len(steps) - 1)]
        number = int(step.inclinometers)
        word = NUMBERS[number] if number < len(NUMBERS) else str(number)
        more = " more" if "theta" in self.case.list_there() else ""
        name = f"{word.capitalize()}{more} inclinometer{' is' if number == 1 else 's are'}"
        gain = f"one more lowers {what} by {_percent(step.next_lowers)}."
        if enough == len(steps):
            return f"{name} not enough: {gain} Look further, e.g. with --count {2 * number}."
        where = f", at {_list(self.choices[enough].heights)} m" if number else ""
        level = (
            f"{step.standard_deviation / MEGA:.3g} M{step.unit}, {_percent(step.share)} of the "
            "standard deviation of the signal itself."
        )
        if np.isnan(step.next_height):
            return f"{name} needed{where}; no height is left for one more. Then {what} is {level}"
        return f"{name} enough{where}: {gain} With {number} it is {level}"

    def _make_table(self, steps: Sequence[Any]) -> Table:
        from rich.text import Text

        stressed, unit = self.quantity == "stress", QUANTITIES[self.quantity][1]
        title = f"Standard deviation σ of the error of {self._name_quantity()}"
        table = start_table(title, padding=(0, 1, 0, 0))
        table.add_column("number", justify="right", no_wrap=True)
        table.add_column("heights (m)")
        for name in (f"σ (M{unit})", "of signal", *(["weld (m)"] if stressed else [])):
            table.add_column(name, justify="right", no_wrap=True)
        table.add_column("one more buys", no_wrap=True)
        for choice, step in zip(self.choices, steps, strict=True):
            gain = f"{_percent(step.next_lowers)} at {step.next_height:.4g} m"
            cells = [
                str(step.inclinometers),
                _list(choice.heights) or "-",
                f"{step.standard_deviation / MEGA:.3g}",
                f"{100.0 * step.share:.3g} %",
                *([f"{step.weld:.4g}"] if stressed else []),
                "-" if np.isnan(step.next_height) else gain,
            ]
            table.add_row(*map(Text, cells))
        return table

    def _tell_origin(self) -> list[str]:
        config, thrust = self.config, self.config.wind.thrust
        rotor = (
            f" The rotor's thrust is {thrust.mean / 1e6:.3g} MN with a standard deviation of "
            f"{thrust.sigma / 1e6:.3g} MN (the defaults of wind.* are a 15 MW turbine's)."
        )
        sigma = [1e6 * channel.sigma for channel in self.case.candidates]
        there = [f"{KIND_NAMES[k]} at {_list(z)} m" for k, z in self.case.list_there().items()]
        chosen = " (spread over the height, as no sensors are named)" if self.spread else ""
        loads = "the truth's own steps"
        if config.filters.inputs == "declared":
            loads = "declared steps; tuning=matched takes the truth's"
        return [
            f"Truth: {describe_truth(config)}, fore-aft.{'' if config.wind.file else rotor}",
            f"Noise: {config.grid.noise[0]:g} % of each signal's standard deviation, per sample at "
            f"{config.record.rate:g} Hz: {min(sigma):.3g} to {max(sigma):.3g} microrad for "
            "inclinometers. It is white, and independent from sensor to sensor, so neighbours "
            "average it.",
            f"There already: {'; '.join(there)}{chosen}.",
            f"Tuning {config.tuning_name}: loads are random walks with {loads}.",
        ]

    def _tell_limits(self, enough: int) -> list[str]:
        name = "AKF_WAVE" if self.case.wave else "AKF"
        start, last = len(self.choices[0].chosen), self.choices[-1]
        chosen = self.choices[min(enough, len(self.choices) - 1)]
        gain = _percent(self._gain(chosen, self.everywhere))
        first = f"the first {start} as the best of all such sets, " if start > 1 else ""
        worst = " The worst weld has the largest part of its own signal; this part is lowered."
        worst = worst if self.quantity == "stress" else ""
        return [
            f"Assumed: the steady covariance of the linear {name} on its own model, which is taken "
            f"for right. It is no record; {self._tell_sweep(chosen)}.",
            "A real inclinometer reads theta - a/g, which the AKF does not know: `sweep` with "
            "faults.accelerated_inclinometers=true says what that costs.",
            f"Enough means: up to {len(last.chosen)}, every further one lowers the standard "
            f"deviation by less than {100.0 * WORTH:g} %. Inclinometers at all "
            f"{len(self.everywhere.chosen)} heights to choose from would lower that of "
            f"{len(chosen.chosen)} by {gain}.",
            f"Chosen: {first}each further one where it lowers most.{worst}",
        ]

    def _tell_sweep(self, chosen: Choice) -> str:
        there = self.case.list_there()
        sensors = {"inclinometers": sorted([*there.get("theta", ()), *chosen.heights])}
        if self.spread:
            sensors["accelerometers"] = there["a"]
        mesh = self.config.nodes
        if any(np.abs(mesh - z).min() > NEAR for heights in sensors.values() for z in heights):
            return "a sweep on records needs the end of a tube at each of these heights"
        words = (
            f"sensors.{name}=[{','.join(f'{height:.9g}' for height in heights)}]"
            for name, heights in sensors.items()
        )
        tuned = f"tuning={self.config.tuning_name}"
        return (
            f"for errors on records run `sweep` with the same overrides, {tuned} and "
            f"{' '.join(words)}"
        )


def _list(heights: Collection[float] | Array) -> str:
    return ", ".join(f"{height:.4g}" for height in heights)


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %" if share >= 0.1 else f"{100.0 * share:.2g} %"
