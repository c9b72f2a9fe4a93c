"""`scenes`: the module of small scenes of the output's tests; results folders made with it."""

import importlib.util
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def scenes():
    path = Path(__file__).parents[1] / "output" / "scenes.py"
    spec = importlib.util.spec_from_file_location("output_test_scenes", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


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
