"""Which software wrote a file, without importing any of it."""

from __future__ import annotations

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version

PACKAGES = ("flowgmo", "numpy", "numba", "scipy", "h5py", "vtk")


@cache
def versions() -> dict[str, str]:
    """Name -> version of Python and of the packages that results depend on; those not installed are absent."""
    found = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found
