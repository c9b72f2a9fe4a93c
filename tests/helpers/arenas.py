"""Arenas of small scenes for tests of the contact engine's parts, and one body of every way to move."""

import numpy as np
from flowgmo_scenes import Scene, ball, deck, driven, on_axis, rigid, table

from flowgmo.bodies.arrays import BALLISTIC, DRIVEN, FORCED, HINGED
from flowgmo.collision.arena import Arena
from flowgmo.world import poses_of

G = 9.81
TENSOR = np.array([[2.0, 0.3, -0.1], [0.3, 1.5, 0.2], [-0.1, 0.2, 1.1]])


def arena_of(text):
    """The arena of a scene, its poses those of the start."""
    s = Scene(text)
    arena = Arena(s.model, s.world.arrays, s.world.laws)
    arena.load(poses_of(s.state), 0.0)
    return arena


def loose(*bodies, **more):
    """A deck whose bodies could collide and never meet; a last ball gives them somebody to collide with."""
    more = {"lo": (-99,) * 3, "hi": (99,) * 3, "g": (0, 0, -G), **more}
    return deck(*bodies, ball((40, 40, 40)), **more)


def kinds():
    """One body of every way to move: name -> (its motion, its text)."""
    loads = "igf(#)=1," + table("fxtobs", [1.0, 2.0]) + " tytobs(1,#)=0.7,"
    wave = "iupre(#)=1, uamp(#)=1.0, ufre(#)=0.9, omztobs(1,#)=2.0,"
    return {
        "ballistic": (BALLISTIC, rigid(TENSOR, 1.5, v=(1, 2, 3), w=(1, 2, 3))),
        "loaded": (FORCED, rigid(TENSOR, 1.5, w=(1, 0.2, 3), more=loads)),
        "fixed point": (FORCED, rigid(TENSOR, 1.5, (0.3, 0, 0), w=(0, 1, 2), more="imoaxs(#)=4,")),
        "hinged": (HINGED, on_axis(0.7, (0, 1, 1), 2.0, (0.3, 0, -0.3), rate=0.5)),
        "driven": (DRIVEN, driven((0, 0, 0), more=wave)),
    }


def scene_of(name, **more):
    body = kinds()[name][1]
    return loose(body, times=[0, 3.0] if name == "loaded" else None, **more)
