"""``python -m latentarm`` is ``latentarm``."""

import sys

from latentarm.cli import main

sys.exit(main())
