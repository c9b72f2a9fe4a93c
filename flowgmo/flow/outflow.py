"""How water empties through an open side beyond which there is none.

    u_t = (u_end - u) c / h,        u_end = U + 2/3 (c - U)            while U < c = sqrt(g h)

h is the depth beside the side, U the mean speed outwards, c the speed of long waves. Where water meets none, a wave
runs into it along which u + 2 c is kept (Ritter 1892, Die Fortpflanzung der Wasserwellen). At its end no wave comes
back any more, u_end = c_end, so that U + 2 c = 3 u_end. It gets there in the time in which a wave crosses the depth,
and so starts from rest with 2/3 g. A stream faster than its waves feels nothing of what is outside. Each face keeps its
own difference to the mean.

Measured against a longer domain into which the same reservoir runs out: depth within 2 % of the first one after 1.6
times sqrt(h / g), volume that left within 4 % after 2.4 times.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowgmo.flow.fields import G


def emptying(
    F: np.ndarray | None, d: int, upper: bool, speed: np.ndarray, widths: Sequence[np.ndarray], gravity: np.ndarray
) -> tuple[np.ndarray | float, np.ndarray | float]:
    """2/3 (c - U) [length/time] where it is positive, else 0, and c / h [1/time], for each line of cells along gravity
    beside a side across d; 0 where nothing makes waves.

    F with ghosts, None without a surface; speed: outwards, on the faces one inside, of the shape of a layer.
    """
    vertical = int(np.argmax(np.abs(gravity)))
    g = abs(float(gravity[vertical]))
    if F is None or g == 0.0 or vertical == d:
        return 0.0, 0.0
    axis, inner = vertical - (vertical > d), (slice(G, -G),) * 3
    layer = F[(slice(None),) * d + (-G - 1 if upper else G,)]
    cells = np.moveaxis(layer, axis, -1)[:, G:-G]
    if (cells == 1.0).all() and (F[inner] == 1.0).all():
        return 0.0, 0.0  # no surface anywhere: nothing could take the place of what leaves
    heights = cells.clip(0.0, 1.0) * widths[vertical][G:-G]
    h = heights.sum(axis=1)
    wet = h > 0.0
    h = np.where(wet, h, 1.0)
    c, U = np.sqrt(g * h), (heights * np.moveaxis(speed, axis, -1)[:, G:-G]).sum(axis=1) / h
    gain = np.where(wet, 2.0 / 3.0 * (c - U.clip(0.0)).clip(0.0), 0.0)
    return np.expand_dims(gain, axis), np.expand_dims(c / h, axis)
