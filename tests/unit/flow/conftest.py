"""Lets the tests of this folder import tests/helpers."""

import sys
from pathlib import Path

HELPERS = next(p / "helpers" for p in Path(__file__).parents if (p / "helpers").is_dir())
sys.path.insert(0, str(HELPERS))
