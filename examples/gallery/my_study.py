"""
My own study
============

A question of one's own, with the sweeps, the store and the maps of the package. ``owtsweep init
study`` writes a package that asks which of mean and median estimates a constant better; it is
installed here into a folder of its own.
"""

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt

import owtsweep

workshop = TemporaryDirectory()
site = Path(workshop.name, "site")
for command in (
    "-m owtsweep init study constant",
    f"-m pip install --quiet --no-deps --no-build-isolation --target {site} ./owtsweep-constant",
):
    subprocess.run(
        [sys.executable, *command.split()], cwd=workshop.name, check=True, capture_output=True
    )

# From here on it is a study as any other.
sys.path.append(str(site))
run = owtsweep.run(["study=constant", "outliers=0.1"])

# %%
# At 10 % of outliers the median of many samples is better, whatever the noise.
summary = run.summary()
figure, axes = plt.subplots(layout="constrained")
for (scheme, samples), cells in summary.groupby(["scheme", "samples"]):
    axes.loglog(cells["noise"], cells["mean"], label=f"{scheme} of {samples:g}")
axes.set(xlabel="noise (m)", ylabel="mean square error (m²)")
axes.legend()
plt.show()
