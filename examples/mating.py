"""One blade in front of one hub: when can they mate, and what would the operator be told?

    python examples/mating.py [OUTAGE] [RECORD]

OUTAGE is the length of an outage of the blade's GNSS in s before the end of the record (default
20), RECORD the number of the record (default 0). The blade hangs held by tugger lines, the hub
sways with 4 s; both carry GNSS and an inertial unit. Printed is, for each estimator of the root,
how many chances to mate it misses and how many of its chances are none; mating.png shows the last
100 seconds. A bad argument ends the program with one line that says what is wrong, and exit code 2.

`python -m owtsweep sweep study=mating` makes maps of the same over sensors.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

import owtsweep
from owtsweep.studies.mating.config import Limits
from owtsweep.studies.mating.measures import compare_chances, find_chances

DISTANCE, SPEED, HOLD = 0.1, 0.1, 2.0  # m, m/s, s
HUB_SCHEME = "HME1"
#: From north and east to the blade's axes, of which x points north and z up.
TO_BLADE = np.array([[1.0, 0.0], [0.0, -1.0], [0.0, 0.0]])
SHOWN = 100.0  # s


def main(arguments: list[str]) -> int:
    outage, number = (*arguments, *("20", "0")[len(arguments) :])
    words = {
        "blade": f"study=blade experiment=held grid.sigma=[0.01] grid.outage=[{outage}] "
        "schemes=[HOLD,UKF,PENDULUM]",
        "hub": "study=hub tuning=matched grid.natural_period=[4] grid.amplitude=[0.1] "
        "sensors.gnss.sigma=0.01 sensors.gnss.rate=5 record.duration=300 baselines=[] "
        f"schemes=[{HUB_SCHEME}]",
    }
    try:
        blade, hub = (owtsweep.estimate(each.split(), int(number)) for each in words.values())
    except owtsweep.InputError as error:
        print(f"mating.py: {error}", file=sys.stderr)
        return 2
    rate = 1.0 / blade.time[1]
    limits, hold = Limits(distance=DISTANCE, speed=SPEED), round(HOLD * rate)
    every = round(blade.time[1] / hub.time[1])
    judged = slice(blade.settled, None)

    def subtract(root, moved):
        """Return position and velocity of the root relative to its place at the hub."""
        position = root["root"] - blade.at_rest["root"] - moved["position"][::every] @ TO_BLADE.T
        return position, root["root_velocity"] - moved["velocity"][::every] @ TO_BLADE.T

    motions = {"truth": subtract(blade.truth, hub.truth)}
    for name in blade.estimates:
        motions[name] = subtract(blade.estimates[name], hub.estimates[HUB_SCHEME])
    chances = {
        name: find_chances(position[judged], velocity[judged], limits, hold)
        for name, (position, velocity) in motions.items()
    }
    print(
        f"Record {number}, outage {outage} s: root and hub can mate (within {DISTANCE:g} m and "
        f"{SPEED:g} m/s for {HOLD:g} s) at {100 * chances['truth'].mean():.0f} % of all moments."
    )
    print("scheme     error of position   missed   imagined")
    for name in blade.estimates:
        error = (motions[name][0] - motions["truth"][0])[judged]
        rms = np.sqrt(np.mean(np.sum(error**2, axis=1)))
        found = compare_chances(chances["truth"], chances[name])
        missed, false = 100 * found["missed"], 100 * found["false"]
        print(f"{name:10s} {rms:14.3f} m {missed:11.0f} % {false:8.0f} %")
    draw(blade.time[judged], motions, chances, judged, f"record {number}, outage {outage} s")
    print("mating.png: the last 100 s")
    return 0


def draw(time, motions, chances, judged, what):
    """Draw the distances of the last seconds, and below them the chances, into mating.png."""
    figure, (above, below) = plt.subplots(
        2, 1, sharex=True, figsize=(9, 5), height_ratios=[3, 1], layout="constrained"
    )
    shown = time >= time[-1] - SHOWN
    for level, (name, (position, _)) in enumerate(reversed(motions.items())):
        look = {"color": "black", "lw": 2.0} if name == "truth" else {"lw": 1.0}
        distance = np.linalg.norm(position[judged], axis=1)
        (line,) = above.plot(time[shown], distance[shown], label=name, **look)
        begins = time[: len(chances[name])]
        marked = np.where(chances[name], float(level), np.nan)
        below.plot(begins[begins >= time[-1] - SHOWN], marked[begins >= time[-1] - SHOWN],
                   color=line.get_color(), lw=5.0, solid_capstyle="butt")  # fmt: skip
    above.axhline(DISTANCE, color="grey", lw=0.8, ls="--")
    above.set_ylabel("root from its place at the hub (m)")
    above.set_ylim(0.0, None)
    above.legend(ncols=len(motions), fontsize=8)
    above.set_title(f"Mating of a blade: {what}; tuning matched, seeds 2018 and 2019", fontsize=10)
    below.set_yticks(range(len(motions)), list(reversed(motions)))
    below.set_ylim(-0.6, len(motions) - 0.4)
    below.set_xlabel("time (s); below: from when on a mating could begin")
    figure.savefig("mating.png", dpi=120)
    plt.close(figure)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
