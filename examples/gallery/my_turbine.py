"""
My turbine and sensors
======================

A hub sways with 3 to 5 s; its receiver gives 5 fixes per second of 2 cm, .3 s late. Which
estimator is best, and what is its error?
"""

import matplotlib.pyplot as plt

import owtsweep

run = owtsweep.run(
    [
        "grid.natural_period=[3,4,5]",
        "grid.amplitude=[0.05,0.1,0.2,0.5,1,2]",
        "grid.replicates=8",
        "record.duration=200",
        "sensors.gnss.rate=5",
        "sensors.gnss.sigma=0.02",
        "sensors.gnss.delay=0.3",
    ]
)

# %%
# Each line of ``best_scheme`` is a cell of the map: the best scheme by position, and its error in
# m. Where a baseline has less error than every scheme, no estimator is needed: NONE is an
# estimate of zero.
best = run.best_scheme()
best = best[best["criterion"] == "position"]
best["winner"] = best["best"].where(~best["baseline_wins"], best["baseline"])
print(best.pivot(index="amplitude", columns="natural_period", values="winner"))

# %%
# Dashed is the error of the best baseline.
figure, axes = plt.subplots(layout="constrained")
for period, cells in best.groupby("natural_period"):
    (line,) = axes.loglog(cells["amplitude"], cells["error_best"], "o-", label=f"{period:g} s")
    axes.loglog(cells["amplitude"], cells["error_baseline"], "--", color=line.get_color())
axes.set(xlabel="amplitude of the motion (m)", ylabel="error of the best scheme (m)")
axes.legend(title="natural period")
plt.show()
