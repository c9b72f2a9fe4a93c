"""`scenes`: the module of small scenes beside this file."""

import importlib.util
import sys
from pathlib import Path

import pytest

HELPERS = next(p / "helpers" for p in Path(__file__).parents if (p / "helpers").is_dir())
sys.path.insert(0, str(HELPERS))


def load(name):
    spec = importlib.util.spec_from_file_location(f"output_test_{name}", Path(__file__).with_name(f"{name}.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def scenes():
    return load("scenes")


@pytest.fixture(scope="session")
def wet():
    """The module of a tank with sloshing water."""
    return load("wet_scenes")
