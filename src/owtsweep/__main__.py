"""`python -m owtsweep`."""

import sys

from owtsweep.cli import main

if __name__ == "__main__":
    sys.exit(main())
