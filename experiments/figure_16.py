"""Figure 16 of Ren et al. (2019): MSE over amplitude at a natural period of 6 s.

    python experiments/figure_16.py [RUN]

draws it for a run that is there, or for the default study (which it runs or finishes first).
"""

import sys

import owtsweep

run = owtsweep.load(sys.argv[1]) if len(sys.argv) > 1 else owtsweep.run()
for file in run.draw("figure_16_mse_6s"):
    print(file)
