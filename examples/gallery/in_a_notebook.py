"""
In a notebook
=============

A run shows itself, as the last line of a cell. Its values are an xarray Dataset (extra ``xarray``),
with names and units, so that any question is one line.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import owtsweep

run = owtsweep.run(
    [
        "grid.natural_period=[3,4,6]",
        "grid.amplitude=[0.1,0.2,0.5,1,2]",
        "grid.replicates=8",
        "record.duration=200",
        "schemes=[MKF,HME1,HME2]",
        f"results={Path.cwd() / 'results'}",  # a notebook may go to another folder
    ]
)
run

# %%
# How many times as large is MKF's mean square error as HME1's, record by record?
errors = run.dataset()["position"].sel(window="settled")
ratios = errors.sel(scheme="MKF") / errors.sel(scheme="HME1")

figure, axes = plt.subplots(layout="constrained")
for period in ratios["natural_period"].values:
    of_period = ratios.sel(natural_period=period)
    (line,) = axes.loglog(ratios["amplitude"], of_period.mean("replicate"), label=f"{period:g} s")
    axes.loglog(ratios["amplitude"], of_period, ".", color=line.get_color())
axes.axhline(1.0, color="black", lw=0.8)
axes.set(xlabel="amplitude of the motion (m)", ylabel="MSE of MKF over that of HME1")
axes.legend(title="natural period")
plt.show()
