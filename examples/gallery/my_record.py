"""
My record
=========

A file holds the recorded motion of a hub: time, x and y. Which scheme should run on it, with the
receiver that is to be bought? Here the file is made up, 120 s of two sines.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import owtsweep

time = np.arange(0.0, 120.0, 0.05)
x = 0.4 * np.sin(2.0 * np.pi * time / 3.6) + 0.1 * np.sin(2.0 * np.pi * time / 8.0)
file = Path("results", "hub.csv")
file.parent.mkdir(exist_ok=True)
pd.DataFrame({"time": time, "x": x, "y": 0.3 * x}).to_csv(file, index=False)

# %%
# Sensors are simulated on the motion, 20 times with other noise. ``advice`` says which scheme to
# run.
replay = owtsweep.replay(file, ["schemes=[MKF,HME1,HME2]", "sensors.gnss.rate=2"])
advice = replay.advice().iloc[0]
print(f"run {advice['recommended']}: error {advice['value_recommended'] ** 0.5:.3f} m")

# %%
# Estimates of the first of them are kept, with their standard deviations.
estimates = replay.estimates()
figure, axes = plt.subplots(layout="constrained")
axes.plot(time, x, color="black", lw=3, alpha=0.3, label="record")
for scheme, found in estimates[estimates["scheme"].isin(["MKF", "HME1"])].groupby("scheme"):
    axes.plot(found["time"], found["x"], label=scheme)
axes.set(xlim=(60.0, 80.0), xlabel="time (s)", ylabel="x (m)")
axes.legend()
plt.show()
