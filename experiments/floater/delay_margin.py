"""How much delay of the optical system a closed loop bears with each scheme.

    python -m experiments.floater.delay_margin [FOLDER]

FOLDER (default: results/floater_delay_margin) gets delay_margin.csv: a row per motion (floater: 38
s at 20 Hz; buoy: 10.4 s at 200 Hz) and scheme, tuning matched, 20 dB, bias .03.

A basin feeds actuators with the estimates. Here a model floater of unit mass, with the natural
frequency w0 and damping ratio of surge, is pushed by an actuator of first order:

    q'' = -w0^2 q - 2 zeta w0 q' + u,    u' = (f - u) / tau,    f = -(K x + C v),

with the estimates x and v of q and q', held over a sample. f is what the numerical substructure
asks for: here a stiffness K = `STIFFNESS` w0^2 and a damping C = `DAMPING` w0. Reports show q some
time ago; accelerometers measure q'' now. The delay margin is the shortest delay with which the loop
is unstable.

A scheme is taken as it is: the responses of its estimates to one report and to one acceleration are
recorded after it has settled, and the loop is judged by Nyquist's criterion. So a scheme must be
linear and settle, which all here do while yaw is zero; only the gain of a bias without walk fades
for ever, and is taken as it is then. A scheme that waits is late by its latency.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.linalg import expm

from experiments.command import read_words, show
from owtsweep.arrays import Array
from owtsweep.io.terminal import show_steps, tell_step
from owtsweep.studies import compose
from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.floater.config import FloaterConfig
from owtsweep.studies.floater.contest import CONTEST
from owtsweep.studies.floater.contract import DOF, Measured, Setting
from owtsweep.studies.floater.declaration import make_setting
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.truth import make_truth

MOTIONS = ("floater", "buoy")
WORDS = ["tuning=matched", "axes=[snr,loss]", "grid.snr=[20]", "grid.delay=[0]", "grid.bias=[.03]"]
#: The substructure's stiffness and damping: over w0^2, and over w0.
STIFFNESS, DAMPING = 0.5, 0.6
#: Time constant of the actuator in s.
ACTUATOR = 0.1
#: Natural periods before a response is recorded, and of the response; then it counts as over.
SETTLING, RESPONSE = 8, 8
#: Longest delay that is tried, in natural periods.
LONGEST = 0.5
#: Delays that are tried before halving.
TRIED = 10
#: Frequencies per recorded one: Nyquist's curve must not jump.
FINER = 8
#: Surge.
X = DOF.index("x")

Complex = NDArray[np.complexfloating[Any, Any]]


@dataclass(frozen=True)
class Loop:
    """The model and its actuator, sampled.

    Attributes
    ----------
    natural, damping
        Natural frequency in rad/s, and damping ratio.
    step
        Sampling interval in s.
    """

    natural: float
    damping: float
    step: float

    def respond(self, z: Complex) -> tuple[Complex, Complex]:
        """Return how position and acceleration respond to the commanded force f at z = exp(i w h).

        Shape as `z`, each.
        """
        w, d, h = self.natural, self.damping, self.step
        model = np.array([
            [0.0, 1.0, 0.0, 0.0],
            [-(w**2), -2.0 * d * w, 1.0, 0.0],
            [0.0, 0.0, -1.0 / ACTUATOR, 1.0 / ACTUATOR],
            [0.0, 0.0, 0.0, 0.0],
        ])  # fmt: skip
        moved = expm(model * h)
        A, B = moved[:3, :3], moved[:3, 3]
        loop = z[:, None, None] * np.eye(3) - A
        states = np.linalg.solve(loop, np.broadcast_to(B[:, None], (len(z), 3, 1)))[..., 0]
        return states[:, 0], states @ model[1, :3]

    def ask(self, position: Complex, velocity: Complex) -> Complex:
        """Return the force that the substructure asks for, with its sign turned."""
        return STIFFNESS * self.natural**2 * position + DAMPING * self.natural * velocity


def find_margins(config: FloaterConfig) -> dict[str, float | str]:
    """Return the delay margin of each scheme in s, by name.

    Infinity: stable with every delay up to `LONGEST` natural periods. A scheme that cannot work
    there has its reason in place of a number.

    Parameters
    ----------
    config
        Its first cell (but for the delay) and record 0 give what schemes believe; sensors are not
        fixed to the body.
    """
    motion = make_truth(config, 0)
    cell = {**CONTEST.list_cells(config)[0], "delay": 0.0}
    setting = make_setting(config, motion, cell)
    section = config.motion.freedoms["x"].resonance
    loop = Loop(2.0 * np.pi / section.period, section.damping, setting.step)
    found: dict[str, float | str] = {}
    for name in config.schemes:
        try:
            found[name] = find_margin(name, setting, loop)
        except Unable as reason:
            found[name] = str(reason)
    return found


def find_margin(name: str, setting: Setting, loop: Loop) -> float:
    """Return the delay margin of a scheme in s, to one sample; 0: it is never stable.

    Delays are tried upwards, then halved; a scheme that is told of delays is recorded with each.

    Raises
    ------
    Unable
        If the scheme cannot work with the setting.
    """
    longest = round(LONGEST * 2.0 * np.pi / loop.natural / setting.step)
    ignorant = record_responses(name, setting, loop, 0)
    told = record_responses(name, setting, loop, longest)
    same = all(np.array_equal(*pair) for pair in zip(ignorant, told, strict=True))

    def is_stable_with(delay: int) -> bool:
        known = ignorant if same else record_responses(name, setting, loop, delay)
        return is_stable(find_loop_gain(known, loop, delay))

    stable = -1
    tried = np.unique(np.round(np.geomspace(1, longest, TRIED)).astype(int))
    for unstable in [0, *map(int, tried)]:
        if not is_stable_with(unstable):
            break
        stable = unstable
    else:
        return float("inf")
    while unstable - stable > 1:
        middle = (stable + unstable) // 2
        if is_stable_with(middle):
            stable = middle
        else:
            unstable = middle
    return unstable * setting.step


def is_stable(gain: Complex) -> bool:
    """Say whether a loop with a gain L is stable, by Nyquist's criterion.

    Without feedback model and scheme are stable, so the loop is if 1 + L does not turn about 0.
    `gain` is that of half the unit circle, from 0 to half the sampling frequency; the other half
    mirrors it.
    """
    curve = 1.0 + gain
    turned = np.angle(curve[1:] / curve[:-1]).sum()
    return bool(abs(turned) < 0.5 * np.pi)


def find_loop_gain(responses: tuple[Array, Array], loop: Loop, delay: int) -> Complex:
    """Return the loop's gain L from frequency 0 to half the sampling frequency.

    Parameters
    ----------
    responses
        As `record_responses` returns them.
    loop
        The model.
    delay
        Of the optical system, in samples.
    """
    by_report, by_acceleration = responses
    count = FINER * len(by_report)
    z = np.exp(2j * np.pi * np.fft.rfftfreq(count))
    position, acceleration = loop.respond(z)
    reported = loop.ask(*np.fft.rfft(by_report, count, axis=0).T) * z**-delay
    measured = loop.ask(*np.fft.rfft(by_acceleration, count, axis=0).T)
    return np.asarray(reported * position + measured * acceleration)


def record_responses(name: str, setting: Setting, loop: Loop, delay: int) -> tuple[Array, Array]:
    """Return what estimates of surge and its velocity do after a report, and an acceleration, of 1.

    Shape (samples, 2) each, from the sample on at which it arrives.
    """
    period = 2.0 * np.pi / loop.natural / setting.step
    before, after = round(SETTLING * period), round(RESPONSE * period)
    told = delay if setting.tuning.delay == "truth" else 0
    prepared = SCHEMES.resolve(name).prepare(replace(setting, delay=told * setting.step))
    responses = []
    for signal in ("report", "acceleration"):
        position, acceleration = (np.zeros((before + after, len(DOF))) for _ in range(2))
        # A report of six zeros is a loss to KF; sway is no part of the loop.
        position[:, 1] = 1.0
        (position if signal == "report" else acceleration)[before, X] = 1.0
        measured = Measured(
            step=setting.step,
            position=position,
            age=np.full(len(position), delay * setting.step),
            lost=np.zeros(len(position), dtype=bool),
            acceleration=acceleration,
            rate=np.zeros((len(position), 3)),
            specific_force=None,
        )
        estimates = prepared.run(measured)
        latency = round(estimates.latency / setting.step)
        found = np.stack([estimates.position[:, X], estimates.velocity[:, X]], axis=-1)
        # An estimate of sample k is there at sample k + latency.
        responses.append(found[before - latency : before - latency + after])
    return responses[0], responses[1]


def main() -> None:
    """Write and print the table of all motions and schemes."""
    folder, _, _ = read_words("results/floater_delay_margin")
    rows = []
    with show_steps():
        for motion in MOTIONS:
            tell_step(f"delay margins, motion={motion}")
            config = compose(["study=floater", f"motion={motion}", *WORDS])
            period = config.motion.freedoms["x"].resonance.period
            for scheme, margin in find_margins(config).items():
                row = {"motion": motion, "scheme": scheme, "margin_s": margin, "reason": ""}
                if isinstance(margin, str):
                    row |= {"margin_s": float("nan"), "reason": margin}
                elif margin == float("inf"):
                    row["reason"] = f"stable with every delay up to {LONGEST * period:g} s"
                rows.append(row)
    folder.mkdir(parents=True, exist_ok=True)
    table = pd.DataFrame(rows)
    table.to_csv(folder / "delay_margin.csv", index=False, float_format="%.4g")
    show(table)
    print(folder / "delay_margin.csv")


if __name__ == "__main__":
    main()
