"""What a run leaves behind: history, restart, pictures for ParaView, log, and the machine-readable summary.

Everything is loaded at first use, so that `flowgmo check` starts without h5py or VTK.
"""

from __future__ import annotations

from importlib import import_module

_HOME = {
    "Fields": "fields",
    "History": "history",
    "OutputError": "errors",
    "RestartError": "errors",
    "RunLog": "log",
    "Snapshots": "vtk",
    "read_restart": "restart",
    "versions": "software",
    "write_restart": "restart",
    "write_run_json": "summary",
}

__all__ = list(_HOME)


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
