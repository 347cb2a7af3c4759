"""Why a scheme wins: its error over the frequency of the motion, and from noise alone.

    python experiments/error_spectra.py [RUN]

draws it for a run that is there, or for the default study (which it runs or finishes first).
"""

import sys

import owtsweep

run = owtsweep.load(sys.argv[1]) if len(sys.argv) > 1 else owtsweep.run()
for file in run.draw("error_spectra"):
    print(file)
