"""
In a notebook
=============

A run shows itself, as the last line of a cell. Its values are an xarray Dataset (extra
``xarray``), with names and units, so that any question is one line.
"""

import matplotlib.pyplot as plt

import owtsweep

run = owtsweep.run(
    [
        "grid.natural_period=[3,4,6]",
        "grid.amplitude=[0.1,0.2,0.5,1]",
        "grid.replicates=8",
        "record.duration=200",
        "schemes=[MKF,HME1,HME2]",
    ]
)
run  # noqa: B018 - a notebook shows it

# %%
# What part of the records does HME1 win against MKF?
errors = run.dataset()["position"].sel(window="settled")
wins = (errors.sel(scheme="HME1") < errors.sel(scheme="MKF")).mean("replicate")

figure, axes = plt.subplots(layout="constrained")
for period in wins["natural_period"].values:
    axes.semilogx(wins["amplitude"], wins.sel(natural_period=period), "o-", label=f"{period:g} s")
axes.set(xlabel="amplitude of the motion (m)", ylabel="records in which HME1 beats MKF")
axes.legend(title="natural period")
plt.show()
