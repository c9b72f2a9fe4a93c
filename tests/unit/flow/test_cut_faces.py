"""Faces sorted into plain, cut and closed."""

import numpy as np
from momentum_scenes import NOTHING, blocks, mesh, shape_of

from flowgmo.flow.columns import all_columns
from flowgmo.flow.favor.cut_faces import NO_SOLIDS, find_cut_faces
from flowgmo.flow.fields import G


def test_every_open_face_is_plain_or_cut():
    grid = mesh((12, 11, 10))
    open = blocks(grid, np.random.default_rng(0), 2)
    columns = all_columns(shape_of(grid))
    cut = find_cut_faces(columns, open)
    least = np.minimum.reduce([*open])
    for c in range(3):
        plain = (cut.plain & (1 << c)) > 0
        listed = np.zeros(plain.shape, int)
        np.add.at(listed, tuple(cut.rows[c][:, :3].T), 1)
        real = np.zeros(plain.shape, bool)
        real[G:-G, G:-G, G:-G] = True
        assert np.array_equal(plain + listed, real & (open[1 + c] > 0))
        near = np.minimum.reduce([np.roll(least, s, axis=d) for d in range(3) for s in (1, 0, -1)])
        near = np.minimum(near, np.roll(near, -1, axis=c))
        assert np.array_equal(plain, real & (near >= 1))
        assert (cut.rows[c][:, 3] == cut.rows[c][:, 2] + 1).all()


def test_no_solids():
    assert find_cut_faces(all_columns((8, 8, 8)), NOTHING) is NO_SOLIDS
