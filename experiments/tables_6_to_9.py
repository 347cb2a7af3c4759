"""Tables 6-9 of Ren et al. (2019): the MSE of every scheme beside the published numbers.

    python experiments/tables_6_to_9.py [RUN]

writes them for a run that is there, or for the default study (which it runs or finishes first).
"""

import sys

import owtsweep

run = owtsweep.load(sys.argv[1]) if len(sys.argv) > 1 else owtsweep.run()
for file in run.draw("tables_6_to_9"):
    print(file)
