"""A first start is announced, a later one is not."""

import subprocess
import sys
from pathlib import Path

from numba import njit

from flowgmo.first_start import TEXT, told_of_compilation

TWICE = """
from numba import njit
from flowgmo.first_start import told_of_compilation

@njit(cache=True)
def twice(x):
    return 2 * x

said = []
with told_of_compilation(said.append):
    twice(1)
    twice(1.0)
print(len(said))
"""


def test_the_first_compilation_is_told_and_only_that():
    said: list[str] = []
    with told_of_compilation(said.append):
        assert said == []
        njit(lambda x: x + 1)(1)
        njit(lambda x: x + 2)(1)
    njit(lambda x: x + 3)(1)
    assert said == [TEXT]


def test_kernels_from_the_cache_are_not_told(tmp_path: Path):
    script = tmp_path / "twice.py"
    script.write_text(TWICE)

    def start() -> str:
        return subprocess.run([sys.executable, script], capture_output=True, text=True, check=True).stdout.strip()

    assert [start(), start()] == ["1", "0"]
