"""Figure 11 of Ren et al. (2019): velocity estimates at a natural period of 3.8 s.

    python experiments/figure_11.py [RUN]

RUN is the folder of a run. Without RUN, the default study is used; it is run first if needed.
"""

import sys

import owtsweep

run = owtsweep.load(sys.argv[1]) if len(sys.argv) > 1 else owtsweep.run()
for file in run.draw("figure_11_velocity"):
    print(file)
