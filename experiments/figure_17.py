"""Figure 17 of Ren et al. (2019): MSE over amplitude at a natural period of 8 s.

    python experiments/figure_17.py [RUN]

RUN is the folder of a run. Without RUN, the default study is used; it is run first if needed.
"""

import sys

import owtsweep

run = owtsweep.load(sys.argv[1]) if len(sys.argv) > 1 else owtsweep.run()
for file in run.draw("figure_17_mse_8s"):
    print(file)
