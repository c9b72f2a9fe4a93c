"""Compilation in a second process: the same kernels as a scene's own, and nothing that depends on it."""

import numpy as np
from flowgmo_scenes import Scene, deck, solid

from flowgmo.collision import ahead
from flowgmo.collision.clusters import resolve
from flowgmo.collision.persistent import solve
from flowgmo.collision.single import strike_exactly


def block(low, high, z, v):
    size = " ".join(f"{a}l(#)={x}, {a}h(#)={y}," for a, x, y in zip("xyz", low, high, strict=True))
    return f"imo(#)=4, rhomvb(#)=1000.0, iob(#)=#, {size} trnz(#)={z}, wtobs(1,#)={v}, omytobs(1,#)=0.3,"


def test_kernels_compiled_ahead_are_those_a_scene_calls():
    """One signature each after both: a second one would be a compilation that helps nobody."""
    ahead.compile_all()
    blocks = [block((-0.1, -0.1, 0.0), (0.1, 0.1, 0.1), 0.102 * k + 0.001, -0.1) for k in range(2)]
    floor = solid((-1, -1, -0.1), (1, 1, 0))
    s = Scene(deck(*blocks, floor, lo=(-1, -1, -1), hi=(1, 1, 1), g=(0, 0, -9.81), e=0.2, mu=0.3))
    s.to(0.5, 0.005)
    assert len(s.state.held_parts) > 4 and len(s.impacts) > 4
    for kernel in (solve, resolve, strike_exactly):
        assert len(kernel.signatures) == 1, kernel


class Child:
    """A process that never ends by itself."""

    made = 0

    def __init__(self, *_, **__):
        Child.made += 1
        self.code = None

    def poll(self):
        return self.code

    def terminate(self):
        self.code = -15

    def wait(self):
        return self.code


def test_a_second_process_is_started_once_and_only_on_a_first_start(monkeypatch, tmp_path):
    stops = []
    monkeypatch.setattr(ahead.subprocess, "Popen", Child)
    monkeypatch.setattr(ahead.atexit, "register", lambda *call: stops.append(call))
    monkeypatch.setattr(ahead, "_started", [])
    monkeypatch.setattr(ahead, "_cores", lambda: 2)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    ahead.compile_ahead()
    ahead.compile_ahead()
    assert Child.made == 1
    monkeypatch.setattr(ahead, "_started", [])  # another run while the first one compiles
    ahead.compile_ahead()
    assert Child.made == 1
    stop, *arguments = stops[0]
    stop(*arguments)  # the run ends before the compilation: the next one starts it anew
    ahead.compile_ahead()
    assert Child.made == 2


def test_nothing_is_started_on_one_core_or_without_a_cache(monkeypatch, tmp_path):
    monkeypatch.setattr(ahead.subprocess, "Popen", Child)
    monkeypatch.setattr(ahead, "_started", [])
    before = Child.made
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(ahead, "_cores", lambda: 1)
    ahead.compile_ahead()
    monkeypatch.setattr(ahead, "_cores", lambda: 2)
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    ahead.compile_ahead()
    assert Child.made == before and np.size(list(tmp_path.iterdir())) == 0
