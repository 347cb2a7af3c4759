"""
Many machines
=============

Two machines with one file system share a run: each computes a part of it, by the same command with
other cells. Here two processes play the machines. A cluster needs no more than a scheduler
(``compute.scheduler``).
"""

import subprocess
import sys

import matplotlib.pyplot as plt

import owtsweep

words = ["grid.natural_period=[4]", "grid.replicates=8", "record.duration=200", "name=shared"]
sweep = [sys.executable, "-m", "owtsweep", "sweep", *words]
machines = [
    subprocess.Popen([*sweep, f"grid.amplitude={part}"], stdout=subprocess.DEVNULL)
    for part in ("[0.1,0.2,0.5]", "[1,2,5]")
]
for machine in machines:
    machine.wait()

# %%
# What both have stored is found; nothing is left to compute.
run = owtsweep.run([*words, "grid.amplitude=[0.1,0.2,0.5,1,2,5]"])
summary = run.summary()
chosen = summary[(summary["measure"] == "position") & (summary["window"] == "settled")]

figure, axes = plt.subplots(layout="constrained")
for scheme, cells in chosen.groupby("scheme"):
    axes.loglog(cells["amplitude"], cells["mean"] ** 0.5, "o-", label=scheme)
axes.set(xlabel="amplitude of the motion (m)", ylabel="rms error (m)", title="natural period 4 s")
axes.legend()
plt.show()
