"""Figure 12 of Ren et al. (2019): velocity estimates at 3.8 s, zoomed in.

    python experiments/figure_12.py [RUN]

RUN is the folder of a run. Without RUN, the default study is used; it is run first if needed.
"""

import sys

import owtsweep

run = owtsweep.load(sys.argv[1]) if len(sys.argv) > 1 else owtsweep.run()
for file in run.draw("figure_12_velocity_zoom"):
    print(file)
