"""Draw why a scheme wins: its error against the motion's frequency, and from noise alone.

    python experiments/error_spectra.py [RUN]

RUN is the folder of a run. Without RUN, the default study is used; it is run first if needed.
"""

import sys

import owtsweep

run = owtsweep.load(sys.argv[1]) if len(sys.argv) > 1 else owtsweep.run()
for file in run.draw("error_spectra"):
    print(file)
