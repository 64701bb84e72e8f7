"""python3 -m mlim."""

import sys

from .command import main

sys.exit(main())
