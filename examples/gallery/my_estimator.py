"""
My estimator
============

An alpha-beta filter of one's own beside the schemes of the package, on the same records. It is
the class ``AlphaBeta`` of the file ``alpha_beta.py`` beside this script; ``owtsweep init scheme
NAME`` writes one to begin with.
"""

import matplotlib.pyplot as plt
from alpha_beta import AlphaBeta

import owtsweep
from owtsweep.testing import check_scheme

# %%
# It keeps the contract: else this line would say what is wrong.
check_scheme(AlphaBeta())

# %%
# One record whole: truth, fixes and what each scheme made of them.
record = owtsweep.estimate(
    [
        "grid.natural_period=[4]",
        "grid.amplitude=[0.5]",
        "record.duration=100",
        "schemes=[MKF,HME1,{_target_:alpha_beta.AlphaBeta,alpha:0.6}]",
        "baselines=[]",
    ]
)
figure, axes = plt.subplots(layout="constrained")
truth = record.truth["position"][:, 0]
axes.plot(record.time, truth, color="black", lw=3, alpha=0.3, label="truth")
fixes = record.measurements["fixes"]
axes.plot(fixes.time, fixes.value[:, 0], "k.", label="fixes, late")
for scheme, found in record.estimates.items():
    axes.plot(record.time, found["position"][:, 0], label=scheme)
axes.set(xlim=(60.0, 75.0), xlabel="time (s)", ylabel="north (m)")
axes.legend()
plt.show()
