"""Figure 18 of Ren et al. (2019): the best scheme over natural period and amplitude.

    python experiments/figure_18.py [RUN]

RUN is the folder of a run. Without RUN, the default study is used; it is run first if needed.
"""

import sys

import owtsweep

run = owtsweep.load(sys.argv[1]) if len(sys.argv) > 1 else owtsweep.run()
for file in run.draw("figure_18_best_scheme"):
    print(file)
