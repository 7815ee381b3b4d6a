"""`python -m bladewright` is the command line."""

import sys

from bladewright.cli import main

sys.exit(main())
