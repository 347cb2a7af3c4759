"""
How many inclinometers
======================

Before any is mounted on a tower: how many are enough, and where? ``owtsweep place`` answers
without any record, from the covariance of the augmented Kalman filter.
"""

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import pandas as pd

workshop = TemporaryDirectory()
command = [sys.executable, "-m", "owtsweep", "init", "structure", "my_tower"]
subprocess.run(command, cwd=workshop.name, check=True, capture_output=True)
structure = Path(workshop.name, "my_tower.yaml")

# %%
# The thrust is that of this smaller turbine. At most six inclinometers may be bought.
wind = ["wind.thrust.mean=4e5", "wind.thrust.sigma=4e4"]  # N
words = ["study=tower", f"structure={structure}", "grid.noise=[3]", *wind, "--count", "6"]
done = subprocess.run(
    [sys.executable, "-m", "owtsweep", "place", *words], capture_output=True, text=True, check=True
)
print(done.stdout)

# %%
# The last line names the folder, which has the table behind the answer.
folder = done.stdout.splitlines()[-1].partition(": ")[2]
table = pd.read_csv(Path(folder, "place.csv"))

figure, axes = plt.subplots(layout="constrained")
axes.plot(table["inclinometers"], 100.0 * table["share"], "o-")
for _, line in table.iterrows():
    axes.annotate(f" {line['next_height']:g} m", (line["inclinometers"], 100.0 * line["share"]))
axes.set(
    xlabel="inclinometers (beside a point: where the next one goes)",
    ylabel="standard deviation of the stress, % of its signal's",
    ylim=(0.0, None),
)
plt.show()
