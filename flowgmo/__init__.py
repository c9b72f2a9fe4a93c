"""flowgmo: rigid bodies that fall, float, are driven and collide in water, from FLOW-3D style decks.

Compiled kernels are kept in a folder named by a hash of the package's sources: numba's own cache does not notice a
change in a helper of another file. The name must be set before numba loads.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
from pathlib import Path

__version__ = "0.1.0"


#: Files and folders that kernels are made of; a test holds that kernels use no other.
KERNEL_SOURCES = ("kernel.py", "compiler.py", "vectors.py", "records.py", "mesh.py", "bodies", "collision", "flow")


def _kernel_folder() -> Path | None:
    """A writable folder for this version of the sources, and None if there is none (kernels then compile each time)."""
    digest = hashlib.blake2b(f"{sys.version}".encode(), digest_size=8)
    package = Path(__file__).parent
    for place in KERNEL_SOURCES:
        for source in sorted([package / place] if place.endswith(".py") else (package / place).rglob("*.py")):
            digest.update(source.read_bytes())
    home = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")  # noqa: PTH111, PTH118
    user = getattr(os, "getuid", lambda: 0)()
    for base in (Path(home) / "flowgmo", Path(tempfile.gettempdir()) / f"flowgmo-{user}"):
        folder = base / f"kernels-{digest.hexdigest()}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    return None


if "NUMBA_CACHE_DIR" not in os.environ and (_folder := _kernel_folder()) is not None:
    os.environ["NUMBA_CACHE_DIR"] = str(_folder)
