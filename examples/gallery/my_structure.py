"""
My structure
============

From a description of tubes, masses and soil to the best estimator in each sea. ``owtsweep init
structure`` writes a description to begin with; its numbers are to be replaced.
"""

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt

import owtsweep

workshop = TemporaryDirectory()
command = [sys.executable, "-m", "owtsweep", "init", "structure", "my_tower"]
subprocess.run(command, cwd=workshop.name, check=True, capture_output=True)
file = Path(workshop.name, "my_tower.yaml")
run = owtsweep.run(
    [
        "motion=plant",
        f"structure={file}",
        "motion.hs=[0.5,1,1.5,2,3]",
        "motion.tp=[5,8]",
        "grid.replicates=8",
        "record.duration=200",
    ]
)
best = run.best_scheme()
best = best[best["criterion"] == "position"]
best["winner"] = best["best"].where(~best["baseline_wins"], best["baseline"])
print(best.pivot(index="hs", columns="tp", values="winner"))

# %%
# The sway follows from waves on the structure, so the axes are those of the sea. Dashed is the
# error of the best baseline: where it is lower, as in low seas, no estimator is needed.
figure, axes = plt.subplots(layout="constrained")
for period, cells in best.groupby("tp"):
    (line,) = axes.semilogy(cells["hs"], cells["error_best"], "o-", label=f"Tp {period:g} s")
    axes.semilogy(cells["hs"], cells["error_baseline"], "--", color=line.get_color())
axes.set(xlabel="significant wave height (m)", ylabel="error of the best scheme (m)")
axes.legend()
plt.show()
