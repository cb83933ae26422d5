"""python -m sigmahat"""

import sys

from sigmahat.cli import main

if __name__ == "__main__":
    sys.exit(main())
