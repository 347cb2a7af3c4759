"""The best scheme as a smooth function of natural period and amplitude, without records."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.figures import style
from owtsweep.figures.palette import style_of
from owtsweep.studies.hub.expected.answers import RESOLUTION, Verdict, judge

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: How much worse the runner-up is, per cent: levels that are drawn.
MARGINS = (10, 50, 200, 1000)
#: A region smaller than this part of the map has no room for its name.
LEAST_REGION = 0.008


def draw(
    values: Array,
    schemes: Sequence[str],
    periods: Array,
    amplitudes: Array,
    *,
    criterion: str,
    window: str,
    tuning: str,
    normalise: str,
    coinciding: Sequence[Sequence[str]] = (),
) -> Figure:
    """Draw the map.

    Parameters
    ----------
    values
        (schemes, periods, amplitudes): expected MSE.
    schemes
        Those compared.
    periods, amplitudes
        Increasing, s and m; both have two values or more.
    """
    verdict = judge(values)
    with style.context():
        figure = style.new_figure(7.6, 5.8)
        axes = figure.add_subplot()
        _regions(axes, verdict, schemes, periods, amplitudes)
        _boundaries(axes, values, periods, amplitudes)
        _margins(axes, verdict, periods, amplitudes)
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter("{x:g}")
        axes.set_xlabel("natural period (s)")
        unit = "largest displacement" if normalise == "peak" else "standard deviation"
        axes.set_ylabel(f"amplitude: {unit} along the waves (m)")
        axes.grid(visible=False)
        axes.set_title(
            f"Best scheme by expected {criterion} MSE\n"
            f"{style.describe_window(window)}, tuning: {tuning}, no records",
            loc="left",
        )
        _legend(figure, verdict, schemes, coinciding)
        style.footnote(figure, _explanation(verdict, coinciding))
    return figure


def _regions(
    axes: Axes, verdict: Verdict, schemes: Sequence[str], periods: Array, amplitudes: Array
) -> None:
    from matplotlib.colors import ListedColormap

    colors = [style_of(name, schemes).color for name in schemes]
    axes.pcolormesh(
        periods, amplitudes, verdict.best.T, cmap=ListedColormap(colors), vmin=-0.5,
        vmax=len(schemes) - 0.5, shading="nearest", rasterized=True,
    )  # fmt: skip
    for number, name in enumerate(schemes):
        won = verdict.best == number
        if won.mean() > LEAST_REGION:
            i, j = _middle(won)
            text: Any = {"ha": "center", "va": "center", "fontsize": 12, "fontweight": "bold"}
            look = style_of(name, schemes)
            box = {"facecolor": look.color, "edgecolor": "none", "pad": 2.0}
            axes.text(periods[i], amplitudes[j], name, color=look.text_color, bbox=box, zorder=5,
                      **text)  # fmt: skip
    unclear = ~verdict.distinguishable
    if unclear.any():
        axes.contourf(periods, amplitudes, unclear.T.astype(float), [0.5, 1.5], colors="none",
                      hatches=["////"])  # fmt: skip
    axes.set_xlim(periods[0], periods[-1])
    axes.set_ylim(amplitudes[0], amplitudes[-1])


def _boundaries(axes: Axes, values: Array, periods: Array, amplitudes: Array) -> None:
    """Lines where a scheme is as good as the best of the others (coinciding ones aside)."""
    for number in range(len(values)):
        others = np.delete(values, number, axis=0)
        alike = np.max(np.abs(others / values[number] - 1.0), axis=(1, 2)) < RESOLUTION
        if len(others[~alike]):
            ahead = np.log(others[~alike].min(axis=0) / values[number])
            if ahead.min() < 0.0 < ahead.max():
                axes.contour(periods, amplitudes, ahead.T, [0.0], colors="black", linewidths=1.4)


def _margins(axes: Axes, verdict: Verdict, periods: Array, amplitudes: Array) -> None:
    """Contours of how much worse the runner-up is."""
    excess = 100.0 * (verdict.mse_runner_up / verdict.mse_best - 1.0)
    if not np.all(np.isfinite(excess)):
        return
    levels = [level for level in MARGINS if excess.min() < level < excess.max()]
    if levels:
        lines = axes.contour(periods, amplitudes, excess.T, levels, colors="black", linewidths=0.6,
                             linestyles="--")  # fmt: skip
        axes.clabel(lines, fmt="%g %%", fontsize=7)


def _middle(region: Array) -> tuple[int, int]:
    """The cell of a region that is farthest from its edge."""
    from scipy.ndimage import distance_transform_edt

    depth = distance_transform_edt(np.pad(region, 1))[1:-1, 1:-1]
    i, j = np.unravel_index(int(np.argmax(depth)), depth.shape)
    return int(i), int(j)


def _legend(
    figure: Figure,
    verdict: Verdict,
    schemes: Sequence[str],
    coinciding: Sequence[Sequence[str]],
) -> None:
    from matplotlib.patches import Patch

    hidden = {name for group in coinciding for name in group[:-1]}
    handles = [
        Patch(color=style_of(name, schemes).color,
              label=f"{name}: {_share(float(np.mean(verdict.best == number)))}")
        for number, name in enumerate(schemes)
        if name not in hidden
    ]  # fmt: skip
    figure.legend(handles=handles, loc="outside upper center", ncols=2, frameon=False)


def _share(won: float) -> str:
    if won == 0.0:
        return "best nowhere"
    return "under 1 % of the map" if won < 0.01 else f"{100 * won:.0f} % of the map"


def _explanation(verdict: Verdict, coinciding: Sequence[Sequence[str]]) -> str:
    sentences = [
        "Full lines: where the best scheme changes. Dashed: by how many per cent the runner-up's"
        " MSE is larger. All values are expectations over all records, computed from error spectra"
        " and noise without any record."
    ]
    if np.mean(~verdict.distinguishable) > LEAST_REGION:
        sentences.append(f"Hatched: the two differ by less than {100 * RESOLUTION:g} %.")
    sentences += [
        f"{' and '.join(group)} give the same numbers and are shown as {group[-1]}."
        for group in coinciding
    ]
    return " ".join(sentences)
