"""The plant of Ren et al. (2019), section 2: Table 3, modes, motion, wind, and the envelope.

    python -m experiments.ren2019.plant RUN [FOLDER]

RUN is the folder of a run of the hub study, over whose map the envelope is drawn. The files are
written into FOLDER (default: plant in the current folder). docs/plant.md explains them.
"""

import sys
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

import owtsweep
from owtsweep.arrays import Array
from owtsweep.figures import style
from owtsweep.io.tables import write_table
from owtsweep.motion.plant import Plant
from owtsweep.motion.whittle import periodogram
from owtsweep.streams import stream
from owtsweep.structures import Structure, compute_modes, find_structure
from owtsweep.studies.hub.figures.envelope import save_envelope
from owtsweep.waves import Sea

#: Of the page answer.md.
TITLE = "# Where the paper's turbine is on the maps"
#: Table 3 of the paper: number of blades -> first natural frequency, Hz.
TABLE_3 = {0: 0.258, 1: 0.249, 2: 0.239}
#: The sea of Table 2: significant wave height (m) and peak period (s).
SEA = Sea(2.87, 6.03)
DURATION, STEP = 2000.0, 0.05  # s
#: Wind: turbulence intensity of the paper's figures, and of IEC 61400-1 the integral scale (m) and
#: the exponent of the mean profile. Drag coefficients are for the larger of the usual values.
INTENSITY, SCALE, EXPONENT, AIR = 0.146, 340.2, 0.14, 1.225
TOWER_DRAG, NACELLE_DRAG, NACELLE_FRONT = 1.0, 1.2, 36.0  # -, -, m^2


def make_all(run: str | Path, folder: Path) -> None:
    """Write all tables and figures into a folder; the envelope is drawn over the map of a run."""
    structure = find_structure("ren2019")
    write_table(folder, "table_3", list_frequencies(structure))
    write_table(folder, "wind", estimate_wind(structure, [8.0, 10.0, 12.0]))
    metadata = {"structure": structure.name}
    with style.context():
        style.save(draw_modes(structure), folder, "modes", metadata)
        style.save(draw_motion(structure), folder, "motion", metadata)
    _, sentences = save_envelope(owtsweep.load(run), structure, folder)
    (folder / "answer.md").write_text("\n\n".join([TITLE, *sentences]) + "\n", "utf-8")
    print(*sentences, sep="\n")


def list_frequencies(structure: Structure) -> pd.DataFrame:
    """Return Table 3: number of blades, published and reproduced first frequency in Hz."""
    rows = [
        (blades, published, float(compute_modes(structure, 1, blades).frequency[0]))
        for blades, published in TABLE_3.items()
    ]
    return pd.DataFrame(rows, columns=["blades", "published", "reproduced"])


def draw_modes(structure: Structure) -> Figure:
    """Draw the shapes of the first three modes over the height, between soil, water and air."""
    modes = compute_modes(structure, 3)
    figure = style.new_figure(6.4, 6.0)
    axes = figure.add_subplot()
    axes.axhspan(structure.bottom, structure.mudline, color="#E8DCC4", zorder=0)
    axes.axhspan(structure.mudline, 0.0, color="#D6EAF5", zorder=0)
    for number, frequency in enumerate(modes.frequency):
        shape = modes.shape[:, number] / np.abs(modes.shape[:, number]).max()
        axes.plot(shape, modes.heights, label=f"mode {number + 1}: {frequency:.3g} Hz")
    for height, text in ((structure.mudline - 3.0, "sand"), (-3.0, "water"), (7.0, "tower")):
        axes.text(-1.15, height, text, va="center")
    axes.axvline(0.0, color="0.5", linewidth=0.8)
    axes.set(xlim=(-1.2, 1.2), xlabel="deflection over its largest", ylabel="height (m)")
    axes.set_title(f"Modes of {structure.name} without blades", loc="left")
    axes.legend(loc="lower right")
    return figure


def draw_motion(structure: Structure) -> Figure:
    """Draw the hub's motion in the sea of Table 2, and its spectrum beside that of the waves."""
    plant = Plant(structure, SEA)
    draw = partial(stream, 2019, "hub", (), 0)
    motion = plant.realise(draw, steps=round(DURATION / STEP), step=STEP)
    figure = style.new_figure(10.0, 3.8)
    left, right = figure.subplots(1, 2)
    time = np.arange(len(motion.position)) * STEP
    part = time < 300.0
    left.plot(time[part], motion.position[part], linewidth=0.8)
    left.set(xlabel="time (s)", ylabel="displacement along the waves (m)")
    rms = motion.position.std()
    left.set_title(f"Hub in Hs {SEA.hs} m, Tp {SEA.tp} s: rms {rms:.2f} m", loc="left")
    frequency, density = smooth(*periodogram(motion.position, STEP))
    right.semilogy(frequency, density, label="displacement of the hub")
    right.semilogy(frequency, SEA.density(frequency), label="elevation of the sea")
    right.axvline(plant.vibration.frequency[0], color="0.5", linestyle=":", label="first mode")
    right.set(xlim=(0.05, 0.6), ylim=(1e-5, 30.0), xlabel="frequency (Hz)", ylabel="m²/Hz")
    right.set_title("Spectral density", loc="left")
    right.legend()
    return figure


def smooth(frequency: Array, density: Array, lines: int = 5) -> tuple[Array, Array]:
    """Return the mean of every few lines of a spectrum up to .7 Hz."""
    count = int(np.searchsorted(frequency, 0.7)) // lines
    kept = (x[: lines * count].reshape(count, lines) for x in (frequency, density))
    return tuple(x.mean(axis=1) for x in kept)


def estimate_wind(structure: Structure, speeds: list[float]) -> pd.DataFrame:
    """Estimate the hub's motion by gusts on the parked tower and nacelle, without a rotor.

    The drag of a gust u on the mean wind U is rho C_D U u per area, with Kaimal's spectrum and the
    exponential coherence of IEC 61400-1. The wind moves the first mode. Its damping of the motion
    is left out, which makes the motion larger.

    Parameters
    ----------
    structure
        The structure.
    speeds
        Mean wind speeds at the hub, m/s.

    Returns
    -------
    DataFrame
        speed (m/s), and the rms of the displacement in m: `rms_resonance`, of the frequencies .2 to
        .32 Hz, and `rms_band`, of .05 to .6 Hz.
    """
    modes = compute_modes(structure, 1)
    ends = np.linspace(0.0, structure.hub, 61)
    heights, length = 0.5 * (ends[1:] + ends[:-1]), ends[1] - ends[0]
    tower = next(tube for tube in structure.tubes if tube.top == structure.hub)
    areas = np.append(TOWER_DRAG * tower.outer(heights) * length, NACELLE_DRAG * NACELLE_FRONT)
    heights = np.append(heights, structure.hub)
    shape = modes.at(heights)[:, 0]
    frequency = np.linspace(0.02, 0.6, 2901)
    apart = np.abs(heights[:, None] - heights)
    rows = []
    for speed in speeds:
        mean = speed * (heights / structure.hub) ** EXPONENT
        weight = AIR * areas * mean * shape
        scaled = frequency * SCALE / speed
        gusts = (INTENSITY * speed) ** 2 * 4.0 * SCALE / speed / (1.0 + 6.0 * scaled) ** (5.0 / 3.0)
        load = [
            weight @ np.exp(-12.0 * np.hypot(f * apart / speed, 0.12 * apart / SCALE)) @ weight
            for f in frequency
        ]
        own, omega = 2.0 * np.pi * modes.frequency[0], 2.0 * np.pi * frequency
        impedance = modes.mass[0] * (own**2 - omega**2 + 2j * modes.damping * own * omega)
        density = gusts * np.array(load) / np.abs(impedance) ** 2
        row = {"speed": speed}
        for name, low, high in (("rms_resonance", 0.2, 0.32), ("rms_band", 0.05, 0.6)):
            inside = (frequency >= low) & (frequency <= high)
            row[name] = float(np.sqrt(np.trapezoid(density[inside], frequency[inside])))
        rows.append(row)
    return pd.DataFrame(rows)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit("usage: python -m experiments.ren2019.plant RUN [FOLDER]")
    target = Path(sys.argv[2] if len(sys.argv) == 3 else "plant")
    target.mkdir(parents=True, exist_ok=True)
    make_all(sys.argv[1], target)
