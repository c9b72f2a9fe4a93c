"""`scenes`: the module of small scenes of the output's tests; results folders made with it."""

import importlib.util
import sys
from pathlib import Path

import pytest

HELPERS = next(p / "helpers" for p in Path(__file__).parents if (p / "helpers").is_dir())
sys.path.insert(0, str(HELPERS))


def load(name):
    path = Path(__file__).parents[1] / "output" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"output_test_{name}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def scenes():
    return load("scenes")


@pytest.fixture(scope="session")
def tank(scenes, tmp_path_factory):
    """Results of water that sloshes around a box, read only."""
    folder = tmp_path_factory.mktemp("results") / "tank.out"
    load("wet_scenes").write_tank(scenes, folder)
    return folder


@pytest.fixture(scope="session")
def anvil(scenes, tmp_path_factory):
    """Results of a bouncing ball, read only."""
    folder = tmp_path_factory.mktemp("results") / "anvil.out"
    scenes.write_anvil(folder)
    return folder


@pytest.fixture(scope="session")
def crowd(scenes, tmp_path_factory):
    """Results of six bodies, read only."""
    folder = tmp_path_factory.mktemp("results") / "crowd.out"
    scenes.write_crowd(folder)
    return folder
