"""Tables 6-9 of Ren et al. (2019): the MSE of every scheme beside the published numbers.

    python experiments/tables_6_to_9.py [RUN]

RUN is the folder of a run. Without RUN, the default study is used; it is run first if needed.
"""

import sys

import owtsweep

run = owtsweep.load(sys.argv[1]) if len(sys.argv) > 1 else owtsweep.run()
for file in run.draw("tables_6_to_9"):
    print(file)
