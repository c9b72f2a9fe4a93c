"""A first start takes long: the user is told so once, when the first kernel is compiled and not loaded.

Which kernels a scene needs is known only as it comes to them, and a cache that other scenes filled may lack these. So
numba is asked: it announces each compilation, after it has looked into its cache (numba.core.event).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

TEXT = (
    "first start of such a scene: its kernels are compiled, half a minute for bodies, two minutes with bodies in "
    "liquid, more on a busy machine; later starts load them\n"
)


@contextmanager
def told_of_compilation(say: Callable[[str], None]) -> Iterator[None]:
    """While this is open the first compilation of a kernel calls say(TEXT). Loads numba."""
    from numba.core import event

    class Once(event.Listener):
        told = False

        def on_start(self, event: object) -> None:
            if not self.told:
                self.told = True
                say(TEXT)

        def on_end(self, event: object) -> None:
            pass

    listener = Once()
    event.register("numba:compile", listener)
    try:
        yield
    finally:
        event.unregister("numba:compile", listener)
