"""Ask where the EKF of tables 7 and 8 stands among linear filters: noise floor against motion term.

    python -m experiments.ren2019.ekf_trade_off [FOLDER]

FOLDER (default: the current folder) gets ekf_trade_off.csv and the figure, as PNG and SVG.

The *noise floor* is the MSE of the position, x + y, without any motion. The *motion term* is the
MSE without any noise, per variance of the motion: 0 for an estimate that follows the motion, 1 for
an estimate of zero. Both are settled. Three families of filters trade one for the other:

- the best linear filter that knows the motion's spectrum, a Wiener filter; its parameter is the
  size of the motion that it expects. No linear filter of the last `WINDOW` seconds is below it.
- the best linear filter that expects motion of any frequency between .05 and .6 Hz alike;
- a leaky double integration of the IMU, without any fix: p'' + 2 zeta w p' + w^2 p = f. Its
  parameter is the corner w.

The sensors are those of table 5. The best filters get the IMU averaged over .1 s.
"""

from functools import partial

import numpy as np
import pandas as pd
from scipy.signal import cont2discrete, lfilter

from experiments.command import read_words, show, write
from experiments.ren2019.published import published_numbers
from owtsweep.figures import style
from owtsweep.studies import compose
from owtsweep.studies.hub.batch import sum_errors
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.records import make_records

PERIOD = 8.0  # s, of tables 7 and 8
WINDOW = 60.0  # s, of measurements that an estimate uses
REST = 0.1  # s, over which the IMU is averaged
BIAS = 1.0  # m/s^2, standard deviation of a constant bias: so large that nothing is known of it
SIZES = np.logspace(-4, 1.5, 23)  # m, rms of the motion that a filter expects
ZETAS = (0.35, 0.7, 1.4)
CORNERS = np.logspace(-0.9, 0.9, 37)  # rad/s
RECORDS = 6  # that a leaky integration is fitted on


def trade_off(sensors, frequency, true, expected):
    """Return the noise floor (m^2) and the motion term of the best filters, shape (sizes, 2).

    `true` is the motion's share of the variance at each `frequency` (Hz), `expected` the share that
    the filter expects. The numbers are means over the age of the newest fix.
    """
    omega = 2.0 * np.pi * frequency
    ages = np.arange(0.0, sensors.fix_step, 0.1)
    results = np.zeros((len(SIZES), 2))
    for age in ages:
        # the estimate is that of time 0
        imu = -REST / 2.0 - REST * np.arange(round(WINDOW / REST))
        fixes = -age - sensors.delay * sensors.step - np.arange(0.0, WINDOW, sensors.fix_step)
        force = -(omega**2) * np.exp(1j * np.outer(imu, omega))
        seen = np.concatenate([force, np.exp(1j * np.outer(fixes, omega))])
        noise = noise_covariance(sensors, imu, fixes)
        covariance, cross = covariances(seen, expected)
        true_covariance, true_cross = covariances(seen, true)
        for number, size in enumerate(SIZES):
            weights = np.linalg.solve(size**2 * covariance + noise, size**2 * cross)
            floor = 2.0 * weights @ noise @ weights  # both axes
            motion = 1.0 - 2.0 * weights @ true_cross + weights @ true_covariance @ weights
            results[number] += np.array([floor, motion]) / len(ages)
    return results


def covariances(seen, share):
    """Return the covariance of measurements of a motion of 1 m^2, and that with its position now.

    `seen` are the phasors of the measurements at each frequency, shape (measurements, frequencies),
    and `share` is the variance at each frequency, m^2.
    """
    return (seen * share @ seen.conj().T).real, (seen @ share).real


def noise_covariance(sensors, imu, fixes):
    """Return the covariance of the noise of IMU means (with a walking bias) and fixes, one axis."""
    count = len(imu)
    noise = np.zeros((count + len(fixes),) * 2)
    bias = BIAS**2 + sensors.bias_walk**2 * (WINDOW + np.minimum.outer(imu, imu))
    noise[:count, :count] = bias + sensors.force_sigma**2 * sensors.step / REST * np.eye(count)
    noise[count:, count:] = sensors.position_sigma**2 * np.eye(len(fixes))
    return noise


def leak(sensors, frequency, true, corner, zeta):
    """Return the noise floor (m^2, x + y) and the motion term of a leaky double integration."""
    density = sensors.force_sigma**2 * sensors.step
    omega = 2.0 * np.pi * frequency
    kept = corner**2 + 2j * zeta * corner * omega
    return density / (2.0 * zeta * corner**3), np.abs(kept / (kept - omega**2)) ** 2 @ true


def published_terms(variance):
    """Return scheme -> noise floor (m^2) and motion term, solved from tables 7 and 8 (x + y)."""
    table = published_numbers()
    table = table[(table.natural_period == PERIOD) & table.measure.isin(["x", "y"])]
    terms = {}
    for scheme, rows in table.groupby("scheme"):
        (low, small), (high, large) = rows.groupby("amplitude").published.sum().items()
        motion = (large - small) / (high**2 - low**2)
        terms[str(scheme)] = (small - low**2 * motion, motion / variance)
    return terms


def fit_leak(config):
    """Fit a leaky integration to the 16 published numbers of the EKF; return a line about it.

    It starts from zero, on records with noise and bias as in the study, without fixes.
    """
    table = published_numbers().query("scheme == 'EKF'")
    records = {p: make_records(config, p, range(RECORDS)) for p in (3.0, 4.0, 8.0)}
    fits = [
        (apart(table, predict_leak(table, records, w, zeta)), w, zeta)
        for w in np.linspace(0.6, 1.0, 9)
        for zeta in (0.5, 0.7, 1.0, 1.4)
    ]
    best, w, zeta = min(fits)
    table["leak"] = predict_leak(table, records, w, zeta)
    fast = table[table.table == 9].groupby(table.measure.str[0] == "v")[["published", "leak"]].sum()
    ratio = fast.loc[True] / fast.loc[False]
    return (
        f"leaky integration closest to the EKF's 16 numbers: w {w:.2f} rad/s, zeta {zeta:g}, mean "
        f"|log2| {best:.2f}; velocity / position in table 9: {ratio.leak:.2f}, published "
        f"{ratio.published:.2f} s^-2"
    )


def apart(table, numbers):
    """Return the mean |log2| between numbers and the published ones."""
    return float(np.mean(np.abs(np.log2(numbers / table.published))))


def predict_leak(table, records, corner, zeta):
    """Return what a leaky integration would have in place of each published number."""
    shares = {"x": 0.75, "y": 0.25}  # of the motion's variance, waves from 30 degrees
    errors = {}
    for measure, numerator in (("", [1.0]), ("v", [1.0, 0.0])):
        model = (numerator, [1.0, 2.0 * zeta * corner, corner**2])
        above, below, _ = cont2discrete(model, 0.01, "bilinear")
        above = above.ravel()
        noise = [lfilter(above, below, n.specific_force[:, 0]) for n in records[8.0].noise]
        for period, some in records.items():
            motion = [
                lfilter(above, below, m.acceleration) - (m.velocity if measure else m.position)
                for m in some.motion
            ]
            errors[measure, period] = np.mean(np.square(motion)), np.mean(np.square(noise))
    return [
        row.amplitude**2 * shares[row.measure[-1]] * errors[row.measure[:-1], row.natural_period][0]
        + errors[row.measure[:-1], row.natural_period][1]
        for row in table.itertuples()
    ]


def correlation(config):
    """Return how far motion's and noise's errors of our EKF correlate in a record: its std."""
    records = make_records(config, PERIOD, range(40))
    chain = resolve("EKF").kernel(Known(records.sensors, config), records.steps)
    (sums,) = sum_errors([chain], records, 0)
    motion, cross, noise = sums.products[1, :2].sum(axis=0)
    return float(np.std(cross / np.sqrt(motion * noise)))


def main(folder):
    """Compute the table, print it, and draw the figure."""
    config = compose(["tuning=paper"])
    records = make_records(config, PERIOD, range(20))
    sensors = records.sensors
    variance = float(np.mean([np.mean(motion.position**2) for motion in records.motion]))
    frequency = np.linspace(*config.band, 1101)
    true = records.source.spectrum.density(frequency)
    true = true / true.sum()
    flat = np.full_like(true, 1.0 / len(true))
    rows = []
    for name, expected in (("knows the spectrum", true), ("expects any motion", flat)):
        terms = trade_off(sensors, frequency, true, expected)
        rows += [(name, size, *both) for size, both in zip(SIZES, terms, strict=True)]
    for zeta in ZETAS:
        name = f"leaky integration, zeta {zeta:g}"
        rows += [(name, w, *leak(sensors, frequency, true, w, zeta)) for w in CORNERS]
    points = published_terms(variance)
    rows += [(f"published {name}", np.nan, *values) for name, values in points.items()]
    columns = ["filter", "parameter", "noise_floor", "motion_term"]
    table = pd.DataFrame(rows, columns=columns)
    show(table)
    print(f"variance of a record whose largest displacement is 1 m: {variance:.4f} m^2")
    print(fit_leak(config))
    print(f"std of the correlation of motion's and noise's errors, EKF: {correlation(config):.2f}")
    write(folder, {"ekf_trade_off": table}, {"ekf_trade_off": partial(draw, table, points)})


def draw(table, points):
    """Draw the motion term over the noise floor: curves of filters, dots of published schemes."""
    figure = style.new_figure(7.6, 4.6)
    axes = figure.add_subplot(
        xlabel="noise floor of the position, x + y (m²)",
        ylabel="motion term: MSE / variance of the motion",
    )
    looks = iter(["k-", "k--", "C0-", "C1-", "C2-"])
    for name, rows in table[table.parameter.notna()].groupby("filter", sort=False):
        axes.loglog(rows.noise_floor, rows.motion_term, next(looks), label=name)
    places = {"EKF": (6, 6), "MKF": (-2, 8), "HME1": (8, -3), "HME2": (-30, -13)}
    for name, point in points.items():
        axes.plot(*point, "o", color="C3", markersize=6)
        axes.annotate(name, point, places[name], textcoords="offset points", color="C3")
    axes.plot([], [], "o", color="C3", label="published, 8 s")
    axes.axhline(1.0, color="0.6", linewidth=0.8)
    axes.annotate(
        "estimate of zero", (9.5e-3, 1.06), ha="right", va="bottom", color="0.4", fontsize=8
    )
    axes.set_xlim(1e-5, 1e-2)
    axes.set_ylim(1e-3, 10.0)
    figure.legend(loc="outside right upper")
    figure.suptitle("Where the published EKF stands among linear filters", x=0.01, ha="left")
    style.footnote(figure, "Tables 7 and 8, with the product of both errors neglected.")
    return figure


if __name__ == "__main__":
    main(read_words(".").folder)
