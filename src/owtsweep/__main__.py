"""`python -m owtsweep`."""

import os
import sys

from owtsweep.cli import INTERRUPTED, main

if __name__ == "__main__":
    code = main()
    if code == INTERRUPTED:
        # Libraries caught while they load may abort the interpreter's own way out.
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    sys.exit(code)
