"""Tells how many inclinometers are enough, and where: a sentence, a table, and their limits."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.io.parted_table import start_table
from owtsweep.structures.bernoulli import NEAR
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contest import describe_truth
from owtsweep.studies.tower.contract import Kind
from owtsweep.studies.tower.placement import Choice, Criterion
from owtsweep.studies.tower.placement_case import PlacementCase

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
    """Inclinometers chosen one by one, an `owtsweep.sweep.placing.Placed`.

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
        return pd.DataFrame(
            {
                "inclinometers": len(choice.chosen),
                "heights": " ".join(f"{height:.9g}" for height in choice.heights),
                "quantity": self.quantity,
                "standard_deviation": self._size(choice),
                "unit": QUANTITIES[self.quantity][1],
                "share": self._share(choice),
                "weld": self.case.welds[choice.weld] if self.quantity == "stress" else np.nan,
                "next_height": _find_added(choice, better) if better else np.nan,
                "next_lowers": self._gain(choice, better),
            }
            for choice, better in self._steps()
        )

    def answer(self) -> RenderableType:
        """Return the sentence that answers, the table, and what both rest on."""
        from rich.console import Group
        from rich.text import Text

        lines = [*self._tell_origin(), *self._tell_limits()]
        return Group(Text(self._tell_enough()), self._make_table(), *(Text(x) for x in lines))

    def _steps(self) -> list[tuple[Choice, Choice | None]]:
        return list(zip(self.choices, [*self.choices[1:], self.further], strict=True))

    def _share(self, choice: Choice) -> float:
        return choice.error(QUANTITIES[self.quantity][0])

    def _size(self, choice: Choice) -> float:
        """Return the standard deviation of the error, Pa or N m."""
        scale = self.case.moment_scale
        if self.quantity == "stress":
            scale = float(self.case.stress_scale[choice.weld])
        return self._share(choice) * scale

    def _gain(self, choice: Choice, better: Choice | None) -> float:
        """Return by which share another set lowers the standard deviation; NaN without one."""
        return 1.0 - self._share(better) / self._share(choice) if better else np.nan

    def _name_quantity(self) -> str:
        if self.quantity == "stress":
            return "the stress at the worst weld"
        low = self.config.heights[0] - self.config.structure.mudline
        where = "base" if low == 0.0 else f"lower cut, {low:g} m above the ground"
        return f"the bending moment at the {where}"

    def _find_enough(self) -> int:
        """Return the first place in `choices` at which no further inclinometer is worth it.

        It is the number of `choices` if even the last of them is not enough.
        """
        worth = [n for n, step in enumerate(self._steps()) if self._gain(*step) >= WORTH]
        return worth[-1] + 1 if worth else 0

    def _tell_enough(self) -> str:
        enough = self._find_enough()
        what = f"the standard deviation of the error of {self._name_quantity()}"
        if enough == len(self.choices):
            choice = self.choices[-1]
            gain = _percent(self._gain(choice, self.further))
            return (
                f"{self._name_number(choice)} not enough: one more lowers {what} by {gain}. "
                f"Look further, e.g. with --count {2 * len(choice.chosen)}."
            )
        choice, better = self._steps()[enough]
        name, unit = self._name_number(choice), QUANTITIES[self.quantity][1]
        where = f", at {_list(choice.heights)} m" if choice.chosen else ""
        level = (
            f"{self._size(choice) / MEGA:.3g} M{unit}, {_percent(self._share(choice))} of the "
            "standard deviation of the signal itself."
        )
        if better is None:
            return f"{name} needed{where}; no height is left for one more. Then {what} is {level}"
        gain = _percent(self._gain(choice, better))
        return (
            f"{name} enough{where}: one more lowers {what} by {gain}. With {len(choice.chosen)} it "
            f"is {level}"
        )

    def _name_number(self, choice: Choice) -> str:
        number = len(choice.chosen)
        word = NUMBERS[number] if number < len(NUMBERS) else str(number)
        more = " more" if any(c.kind == "theta" for c in self.case.setting.channels) else ""
        verb = " is" if number == 1 else "s are"
        return f"{word.capitalize()}{more} inclinometer{verb}"

    def _make_table(self) -> Table:
        from rich.text import Text

        unit = QUANTITIES[self.quantity][1]
        title = f"Standard deviation σ of the error of {self._name_quantity()}"
        table = start_table(title, padding=(0, 1, 0, 0))
        table.add_column("number", justify="right", no_wrap=True)
        table.add_column("heights (m)")
        weld = ["weld (m)"] if self.quantity == "stress" else []
        for name in (f"σ (M{unit})", "of signal", *weld):
            table.add_column(name, justify="right", no_wrap=True)
        table.add_column("one more buys", no_wrap=True)
        for choice, better in self._steps():
            cells = [
                str(len(choice.chosen)),
                _list(choice.heights) or "-",
                f"{self._size(choice) / MEGA:.3g}",
                f"{100.0 * self._share(choice):.3g} %",
            ]
            if self.quantity == "stress":
                cells.append(f"{self.case.welds[choice.weld]:.4g}")
            gain = _percent(self._gain(choice, better))
            cells.append(f"{gain} at {_find_added(choice, better):.4g} m" if better else "-")
            table.add_row(*(Text(cell) for cell in cells))
        return table

    def _tell_origin(self) -> list[str]:
        config, case = self.config, self.case
        thrust = config.wind.thrust
        lines = [f"Truth: {describe_truth(config)}, fore-aft."]
        if config.wind.file is None:
            lines[0] += (
                f" The rotor's thrust is {thrust.mean / 1e6:.3g} MN with a standard deviation of "
                f"{thrust.sigma / 1e6:.3g} MN (the defaults of wind.* are a 15 MW turbine's)."
            )
        sigma = [1e6 * channel.sigma for channel in case.candidates]
        lines.append(
            f"Noise: {config.grid.noise[0]:g} % of each signal's standard deviation, per sample at "
            f"{config.record.rate:g} Hz: {min(sigma):.3g} to {max(sigma):.3g} microrad for "
            "inclinometers. It is white, and independent from sensor to sensor, so neighbours "
            "average it."
        )
        there = [f"{KIND_NAMES[k]} at {_list(z)} m" for k, z in self.case.list_there().items()]
        chosen = " (spread over the height, as no sensors are named)" if self.spread else ""
        lines.append(f"There already: {'; '.join(there)}{chosen}.")
        loads = "the truth's own steps"
        if config.filters.inputs == "declared":
            loads = "declared steps; tuning=matched takes the truth's"
        lines.append(f"Tuning {config.tuning_name}: loads are random walks with {loads}.")
        return lines

    def _tell_limits(self) -> list[str]:
        name = "AKF_WAVE" if self.case.wave else "AKF"
        start, last = len(self.choices[0].chosen), self.choices[-1]
        chosen = self.choices[min(self._find_enough(), len(self.choices) - 1)]
        gain = _percent(self._gain(chosen, self.everywhere))
        first = f"the first {start} as the best of all such sets, " if start > 1 else ""
        worst = ""
        if self.quantity == "stress":
            worst = " The worst weld has the largest part of its own signal; this part is lowered."
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


def _find_added(choice: Choice, better: Choice) -> float:
    return (set(better.heights) - set(choice.heights)).pop()


def _list(heights: Collection[float] | Array) -> str:
    return ", ".join(f"{height:.4g}" for height in heights)


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %" if share >= 0.1 else f"{100.0 * share:.2g} %"
