"""Figure 18 of Ren et al. (2019): the best scheme over natural period and amplitude.

    python experiments/figure_18.py [RUN]

draws it for a run that is there, or for the default study (which it runs or finishes first).
"""

import sys

import owtsweep

run = owtsweep.load(sys.argv[1]) if len(sys.argv) > 1 else owtsweep.run()
for file in run.draw("figure_18_best_scheme"):
    print(file)
