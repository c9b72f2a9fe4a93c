"""Curves of history.h5 against time, one panel per unit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from postproc import style
from postproc.errors import WrongRequest
from postproc.results import Curve, Results

LINES = ("-", "--", ":", "-.")
FEW_POINTS = 40  # up to here each row gets a mark


def plot(
    results: Results, quantities: list[str], path: Path, body: str | None = None, component: str | None = None
) -> Path:
    """Draw quantities ("bodies/ball/position", or "position" of every body) and return the file written."""
    curves = [results.curve(name) for quantity in quantities for name in results.resolve(quantity, body)]
    for curve in curves:
        if component is not None and component not in curve.columns and curve.columns != ("",):
            raise WrongRequest(f"{curve.name} has no component {component}; it has {', '.join(curve.columns)}")
    panels: dict[tuple[str, str], list[Curve]] = {}
    for curve in curves:
        panels.setdefault((_kind(curve), curve.unit), []).append(curve)
    figure, rows = plt.subplots(
        len(panels), 1, figsize=(9, 1.6 + 3.2 * len(panels)), squeeze=False, sharex=True, layout="constrained"
    )
    figure.suptitle(results.title, fontsize=13, fontweight="bold", x=0.02, ha="left")
    for axes, group in zip(rows[:, 0], panels.values(), strict=True):
        _panel(axes, group, component)
    t = np.concatenate([results.t[[0, -1]] if len(results.t) else [], *(c.t for c in curves)])
    if len(t) == 0:
        raise WrongRequest(f"{results.path} holds no rows yet")
    style.fit_time(rows[-1, 0], t.min(), t.max(), results.time_unit)
    return style.save(figure, path)


def _kind(curve: Curve) -> str:
    """What may share a panel: energies together, otherwise quantities of one name."""
    return "energy" if "energy" in curve.name else curve.name.rsplit("/", 1)[-1]


def _panel(axes: plt.Axes, group: list[Curve], component: str | None) -> None:
    owners = {_owner(curve) for curve in group}
    names = {curve.name.rsplit("/", 1)[-1] for curve in group}
    lines = 0
    for k, curve in enumerate(group):
        shown = [j for j, c in enumerate(curve.columns) if component is None or c in (component, "")]
        for j in shown:
            words = [_owner(curve)] if len(owners) > 1 else []
            words += [curve.name.rsplit("/", 1)[-1].replace("_", " ")] if len(names) > 1 else []
            words += [curve.columns[j]] if len(shown) > 1 else []
            look = {"color": style.colour(j if len(group) == 1 else k), "label": " ".join(words)}
            if curve.name.startswith("collisions/"):
                look |= {"ls": "", "marker": "o", "ms": 4}
            else:
                look |= {"ls": LINES[j % 4] if len(shown) > 1 and (len(group) > 1 or j == 1) else "-"}
                look |= {"marker": "o", "ms": 3.5} if len(curve.t) <= FEW_POINTS else {}
            axes.plot(curve.t, curve.y[:, j], **look)
            lines += bool(words)
    what = names.pop() if len(names) == 1 else "energy"
    what += " energy" if owners == {"energy"} and what != "energy" else ""
    what += f" {component}" if component and group[0].columns != ("",) else ""
    axes.set_ylabel(style.label(what, group[0].unit))
    if len(owners) == 1 and (owner := owners.pop()) not in ("energy", ""):
        axes.set_title(owner)
    if lines > 1:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.4)


def _owner(curve: Curve) -> str:
    """ "ball" of bodies/ball/position; "energy" of energy/kinetic."""
    parts = curve.name.split("/")
    return parts[-2] if len(parts) > 1 else ""
