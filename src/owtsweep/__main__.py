"""`python -m owtsweep`."""

import os
import sys

from owtsweep.cli import INTERRUPTED, main

if __name__ == "__main__":
    code = main()
    if code == INTERRUPTED:
        # A library interrupted while it loads may abort the normal exit of the interpreter.
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    sys.exit(code)
