"""What can go wrong with files, in one place: every failure to write becomes an OutputError that names the file."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from flowgmo.errors import FlowgmoError


class OutputError(FlowgmoError):
    """A result file cannot be written; the text names the file and the reason."""

    code = 1  # the run failed (DESIGN 8)

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(f"cannot write {path}: {reason}")
        self.path = path
        self.reason = reason


class NotContinued(OutputError):
    """A result file is none that this run could go on with, so the command line is wrong."""

    code = 2


class RestartError(FlowgmoError):
    """A restart file is missing, damaged, or belongs to another scene."""


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Whatever fails inside leaves as an OutputError.

    h5py reports a full disk as OSError, RuntimeError, or ValueError.
    """
    try:
        yield
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        raise OutputError(path, reason_of(error)) from error


def reason_of(error: Exception) -> str:
    """One line for people."""
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    return " ".join(str(error).split()) or type(error).__name__


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary file beside `path` that takes its place if all goes well and vanishes if not.

    A reader sees the old file or the new one, never a half, also when the machine stops in between.
    """
    temporary = path.with_name(f".{path.stem}.part{path.suffix}")  # the suffix stays: writers may look at it
    try:
        with writing(path):
            yield temporary
            with temporary.open("rb+") as file:
                os.fsync(file.fileno())
            temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def make_sure_of_room(path: Path, size: int) -> None:
    """Raise OutputError unless `path` can grow by `size` bytes.

    HDF5 does not survive a write that fails: it prints tracebacks and brings the program down when the file is closed.
    So what it is going to write is asked for beforehand.
    """
    if not hasattr(os, "posix_fallocate"):
        return
    with writing(path):
        file = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            before = os.fstat(file).st_size
            try:
                os.posix_fallocate(file, before, size)
            finally:
                os.ftruncate(file, before)
        finally:
            os.close(file)


def make_folder(path: Path) -> Path:
    """Make a folder and those above it."""
    with writing(path):
        path.mkdir(parents=True, exist_ok=True)
    return path
