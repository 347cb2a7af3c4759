"""
Compare two runs
================

What does a receiver of 5 Hz buy over one of 1 Hz? Both runs see the same motion and the same
noise of the IMU, so small differences show.
"""

import matplotlib.pyplot as plt

import owtsweep

words = ["grid.natural_period=[4]", "grid.replicates=8", "record.duration=200"]
runs = {rate: owtsweep.run([*words, f"sensors.gnss.rate={rate}"]) for rate in (1, 5)}

# %%
# ``owtsweep compare RUN RUN`` writes maps of the difference with its tests; here is the plain
# ratio.
figure, axes = plt.subplots(layout="constrained")
for rate, run in runs.items():
    best = run.best_scheme()
    best = best[best["criterion"] == "position"]
    axes.loglog(best["amplitude"], best["error_best"], "o-", label=f"{rate} fixes per second")
axes.set(xlabel="amplitude of the motion (m)", ylabel="error of the best scheme (m)")
axes.legend()
plt.show()
