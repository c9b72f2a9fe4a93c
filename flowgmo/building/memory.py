"""Whether the machine can hold the arrays of mesh size, asked before any of them is made."""

from __future__ import annotations

import os
import resource
from contextlib import suppress
from pathlib import Path

from flowgmo.building.findings import Findings
from flowgmo.flow_plan import CELL_BYTES, mesh_bytes
from flowgmo.mesh import Mesh

CONTAINER = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")  # Linux, both generations


def machine_memory() -> int | None:
    """Bytes that a process may hold here: of the machine, of its container, of its own limit; None if nobody knows."""
    limits = []
    with suppress(AttributeError, ValueError, OSError):
        limits.append(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    for path in CONTAINER:
        with suppress(OSError, ValueError):  # no such file, or 'max'
            limits.append(int(Path(path).read_text()))
    limits.append(resource.getrlimit(resource.RLIMIT_AS)[0])
    return min((n for n in limits if n > 0), default=None)


def check_memory(found: Findings, mesh: Mesh) -> None:
    """Problem: the mesh needs more than the machine has."""
    needed = sum(mesh_bytes(block) for block in mesh.blocks)
    there = machine_memory()
    if there is None or needed <= there:
        return
    deck = found.deck
    names = ["NTOTAL", "SIZE", "NXCELT", "NYCELT", "NZCELT", "NXCELL", "NYCELL", "NZCELL", "SIZEX", "SIZEY", "SIZEZ"]
    name = next((n for n in names if deck.given(n)), "PX")
    index = min(deck.indices(name), default=(1,))
    cells = there // CELL_BYTES
    found.problem(
        name, *index,
        wrong=f"{mesh.cells:,} cells need {needed / 2**30:.3g} GiB, this machine has {there / 2**30:.3g} GiB",
        write=f"Write a mesh of at most {cells:,} cells",
    )  # fmt: skip
