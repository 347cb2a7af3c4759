"""What an IMU that leans with the tower costs over the natural period, and what knowing it saves.

    python -m experiments.tilt [FOLDER]

Writes tilt_cost.csv, tilt_cost.png and tilt_cost.svg into FOLDER (default: results/tilt). The tilt
is that of the first mode of Ren's turbine (conf/structure/ren2019.yaml); the schemes are those of
tuning=matched at the default sensors.

No record is drawn: the errors are settled means, motion's part by the error spectrum, noise's part
by the noise floor. So they are those of engine=expected in the window "settled".
"""

from collections.abc import Mapping, Sequence
from functools import partial
from itertools import product

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import owtsweep
from experiments.command import read_words, write
from owtsweep.config import changed
from owtsweep.figures import style
from owtsweep.figures.palette import style_of
from owtsweep.structures import compute_modes, find_structure
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.bounds.kalman import bound_of_axis
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, resolve_all
from owtsweep.studies.hub.error_spectrum import error_spectrum, expected_mse, look_constant
from owtsweep.studies.hub.noise_floor import noise_floor
from owtsweep.studies.hub.tuning_rules import assume_tilt

AMPLITUDES = (0.5, 2.0)  # m, largest displacement
PERIODS = np.arange(3.0, 8.01, 0.5)  # s
#: What the schemes believe of the tilt: name -> factor on the true tilt; None: the IMU is level.
KNOWLEDGE: Mapping[str, float | None] = {
    "level": None,
    "unknown": 0.0,
    "20 % too small": 0.8,
    "20 % too large": 1.2,
    "known": 1.0,
}
#: Largest displacement of a record over its standard deviation, as records of 1000 s have it.
PEAK = 3.5
#: Number of frequencies in the band at which motion's part is computed.
POINTS = 96
#: Knowledge -> title of its panel. The panels of a tilt that is 20 % wrong show the larger error.
PANELS = {
    "level": "level IMU",
    "unknown": "it leans, nobody knows",
    "20 %": "it leans, known to 20 %",
    "known": "it leans, known exactly",
}


def compare_knowledge(
    config: HubConfig, tilt: float, periods: Sequence[float], amplitudes: Sequence[float]
) -> pd.DataFrame:
    """Compute each scheme's settled error for a level IMU, and for what it knows of a tilt.

    Parameters
    ----------
    config
        The configuration of a hub study with one tuning.
    tilt
        Lean of the IMU per displacement, rad/m.
    periods
        Natural periods, s; the motion's spectrum is Eq. (1) of Ren et al. (2019).
    amplitudes
        Largest displacements, m; the standard deviation is 1 / `PEAK` of it.

    Returns
    -------
    DataFrame
        Columns knowledge (see `KNOWLEDGE`), scheme, amplitude, natural_period, mse_position (m^2),
        mse_velocity ((m/s)^2) and bound_position (m^2), the Kalman bound with the tilt known.

    Raises
    ------
    InputError
        If the errors of a scheme do not settle.
    """
    rows = []
    low, high = config.band
    for knowledge, factor in KNOWLEDGE.items():
        sensors = sensing.sensors(config.sensors)
        if factor is not None:
            imu = changed(config.sensors.imu, tilt=tilt)
            sensors = sensing.sensors(changed(config.sensors, imu=imu))
        assumed = assume_tilt(config, 0.0 if factor is None else factor * tilt)
        frequency = np.geomspace(low, high, POINTS)
        frequency = frequency[~look_constant(frequency * sensors.fix_step)]
        bound = 2.0 * bound_of_axis(sensors)[0]
        for scheme in resolve_all(assumed.schemes, assumed):
            chain = scheme.kernel(Known(sensors, assumed))
            errors, noise = error_spectrum(chain, sensors, frequency), noise_floor(chain, sensors)
            band = (float(frequency[0]), float(frequency[-1]))
            for amplitude, period in product(amplitudes, periods):
                shape = config.spectrum.at(period)
                rms = amplitude / PEAK
                position, velocity = expected_mse(errors, shape.density, band, rms=rms)
                rows.append({
                    "knowledge": knowledge,
                    "scheme": scheme.name,
                    "amplitude": amplitude,
                    "natural_period": period,
                    "mse_position": position + noise.of("position"),
                    "mse_velocity": velocity + noise.of("velocity"),
                    "bound_position": bound,
                })  # fmt: skip
    return pd.DataFrame(rows)


def draw_costs(costs: pd.DataFrame, *, title: str, origin: str) -> Figure:
    """Draw each scheme's root of the settled MSE over the natural period, one panel per knowledge.

    Parameters
    ----------
    costs
        The table of `compare_knowledge`.
    title, origin
        Title of the figure, and the text on the truth and the tuning below it.
    """
    amplitudes = sorted(costs["amplitude"].unique())
    figure = style.new_figure(13.0, 1.0 + 3.4 * len(amplitudes))
    grid = figure.subplots(len(amplitudes), len(PANELS), sharex=True, sharey="row", squeeze=False)
    for row, amplitude in zip(grid, amplitudes, strict=True):
        for axes, knowledge in zip(row, PANELS, strict=True):
            meant = [name for name in KNOWLEDGE if name.startswith(knowledge)]
            chosen = costs["knowledge"].isin(meant) & (costs["amplitude"] == amplitude)
            _draw_panel(axes, costs[chosen])
        largest = costs[costs["amplitude"] == amplitude]["mse_position"].max()
        row[0].set_ylim(0.0, 1.05 * np.sqrt(largest))
        row[0].set_ylabel(f"amplitude {amplitude:g} m\nposition error, rms of x + y (m)")
    for axes, head in zip(grid[0], PANELS.values(), strict=True):
        axes.set_title(head, fontsize=10)
    for axes in grid[-1]:
        axes.set_xlabel("natural period (s)")
    figure.suptitle(title, x=0.01, ha="left", fontsize=11)
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right center", frameon=False)
    style.footnote(figure, origin)
    return figure


def _draw_panel(axes: Axes, part: pd.DataFrame) -> None:
    """Draw the errors of one panel; of several rows of a scheme and a period the largest."""
    schemes = list(dict.fromkeys(part["scheme"]))
    for name in schemes:
        error = part[part["scheme"] == name].groupby("natural_period")["mse_position"].max()
        look = style_of(name, schemes)
        axes.plot(
            error.index, np.sqrt(error), color=look.color, linestyle=look.line, marker=look.marker,
            label=name,
        )  # fmt: skip
    bound = part.groupby("natural_period")["bound_position"].max()
    axes.plot(
        bound.index, np.sqrt(bound), color="0.35", linewidth=1.2, linestyle=(0, (1, 1)),
        label="bound, tilt known",
    )  # fmt: skip


def main() -> None:
    """Write the table, and draw the figure."""
    folder, _, _ = read_words("results/tilt")
    modes = compute_modes(find_structure("ren2019"), 1)
    tilt = float(modes.slope[0])
    config = owtsweep.studies.compose(["tuning=matched"])
    costs = compare_knowledge(config, tilt, PERIODS, AMPLITUDES)
    title = f"What a tilt of the IMU of {tilt:.4f} rad/m costs, and what knowing it gives back"
    origin = (
        f"Tuning {config.tuning_name}, default sensors. Settled errors by linear theory, so there "
        "are no records and no seed. Known to 20 %: the larger error of two beliefs, 20 % too "
        "small and 20 % too large. "
        "The bound is of the Kalman filter that assumes nothing about the motion."
    )
    draw = partial(draw_costs, costs, title=title, origin=origin)
    write(folder, {"tilt_cost": costs}, {"tilt_cost": draw})


if __name__ == "__main__":
    main()
