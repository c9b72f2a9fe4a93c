"""What to tell a user whose bodies press liquid together that has nowhere to go."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowgmo.errors import StepFailed
from flowgmo.flow.fields import G
from flowgmo.flow.immersed.immersed import Immersed
from flowgmo.flow.pressure.sealed import PressedTogether, Sealed
from flowgmo.mesh import Block


def explained(
    error: StepFailed, sealed: Sealed, immersed: Immersed, velocities: np.ndarray, names: Sequence[str], block: Block
) -> StepFailed:
    """The error itself, or where it is of a closed space that bodies press: one that names space and body.

    velocities (k, 6) of the moving bodies with these names.
    """
    cause = error.__cause__
    if not isinstance(cause, PressedTogether):
        return error
    region = np.zeros(immersed.open.V.shape, np.int64) if sealed.label is None else sealed.label
    inside, k = region >= 0, cause.region
    pushed = [
        float((one.whole @ U)[region.reshape(-1)[one.cells] == k].sum())
        for one, U in zip(immersed.fluxes, velocities, strict=True)
    ]
    if not any(pushed):
        return error
    body = names[int(np.argmax(np.abs(pushed)))]
    here = (inside & (region == k))[G:-G, G:-G, G:-G]
    ends = []
    for name, planes, axis in zip("xyz", block.planes, range(3), strict=True):
        some = np.flatnonzero(here.any(axis=tuple(d for d in range(3) if d != axis)))
        ends.append(f"{name} = {planes[some[0]]:.6g} to {planes[some[-1] + 1]:.6g}")
    how = "presses liquid together" if cause.inflow > 0.0 else "pulls liquid apart"
    return StepFailed(
        f"body {body} {how} that fills a closed space of {int(sealed.cells[k])} cells, {', '.join(ends)}. Give the "
        "space an opening (a gap beside the body, or a side with ibct 3, 5 or 8), or let the liquid give way by rcsql "
        "in &props"
    )
