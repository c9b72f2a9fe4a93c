"""Curves of history.h5 against time, one panel per unit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from postproc import style
from postproc.errors import WrongRequest
from postproc.look import scale_colour
from postproc.palette import COLOURS
from postproc.results import Curve, Results

WORDS = {"p": "pressure", "F": "liquid fraction", "u": "velocity u", "v": "velocity v", "w": "velocity w"}
FEW_NAMES, MOST_NAMES, SOME_NAMES = 10, 18, 8  # of a legend beside a panel: in full size, at all, of more than that


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
    style.headline(figure, results.title, 13)
    looks = _looks(list(panels.values()), component)
    above = ""
    for axes, group in zip(rows[:, 0], panels.values(), strict=True):
        owners = {_owner(curve) for curve in group}
        _panel(axes, group, looks, component)
        if len(owners) == 1 and (owner := owners.pop()) not in ("energy", above):
            axes.set_title(style.plain(owner))
            above = owner
    t = np.concatenate([results.t[[0, -1]] if len(results.t) else [], *(c.t for c in curves)])
    if len(t) == 0:
        raise WrongRequest(f"{results.path} holds no rows yet")
    style.fit_time(rows[-1, 0], t.min(), t.max(), results.time_unit)
    return style.save(figure, path)


def _kind(curve: Curve) -> str:
    """What may share a panel: energies together, otherwise quantities of one name."""
    return "energy" if "energy" in curve.name else curve.name.rsplit("/", 1)[-1]


def _looks(groups: list[list[Curve]], component: str | None) -> dict[str, dict]:
    """Colour and stroke of each curve's key, the same in all panels."""
    shared = [{_key(curve, group): _one(curve, component) for curve in group} for group in groups if len(group) > 1]
    strokes = style.strokes(*shared)
    keys = dict.fromkeys(key for panel in shared for key in panel)
    n = len(keys)
    if n > len(COLOURS):  # colours along a scale, in the order of the deck
        return {key: {"color": scale_colour(k / (n - 1)), "zorder": 3 + k / n} for k, key in enumerate(keys)}
    return {key: {"color": style.colour(k)} | strokes[key] for k, key in enumerate(keys)}


def _key(curve: Curve, group: list[Curve]) -> str:
    """What a curve stands for in all panels: its body where a panel compares bodies, else its quantity."""
    bodies = len({_owner(c) for c in group}) > 1 and len({c.name.rsplit("/", 1)[-1] for c in group}) == 1
    return _owner(curve) if bodies else curve.name


def _panel(axes: plt.Axes, group: list[Curve], looks: dict[str, dict], component: str | None) -> None:
    names = {curve.name.rsplit("/", 1)[-1] for curve in group}
    owners = {_owner(curve) for curve in group}
    lines = 0
    alone = style.strokes(dict(enumerate(group[0].y.T)))
    for curve in group:
        shown = [j for j, c in enumerate(curve.columns) if component is None or c in (component, "")]
        for j in shown:
            words = [_owner(curve)] if len(owners) > 1 else []
            words += [curve.name.rsplit("/", 1)[-1].replace("_", " ")] if len(names) > 1 else []
            words += [curve.columns[j]] if len(shown) > 1 else []
            look = looks[_key(curve, group)] if len(group) > 1 else {"color": style.colour(j)} | alone[j]
            look = look | {"label": style.plain(" ".join(words))}
            if curve.name.startswith("collisions/"):
                look |= {"ls": "", "marker": "o", "ms": 4}
            else:
                several = len(group) > 1 and len(shown) > 1  # bodies by colours, components by strokes
                look |= {"ls": style.LINES[j % 4]} if several else {}
                look |= style.rows_as_dots(curve.t)
            axes.plot(curve.t, curve.y[:, j], **look)
            lines += bool(words)
    what = names.pop() if len(names) == 1 else "energy"
    what = WORDS.get(what, what)
    what += " energy" if owners == {"energy"} and what != "energy" else ""
    what += f" {component}" if component and group[0].columns != ("",) else ""
    axes.set_ylabel(style.label(what, group[0].unit))
    style.fit_values(axes)
    if lines > 1:
        _legend(axes)


def _one(curve: Curve, component: str | None) -> np.ndarray:
    """The component, else the first one."""
    return curve.y[:, curve.columns.index(component) if component in curve.columns else 0]


def _legend(axes: plt.Axes) -> None:
    """Beside the panel; of many names some that lie evenly among them."""
    handles, texts = axes.get_legend_handles_labels()
    if (n := len(texts)) > MOST_NAMES:
        some = np.linspace(0, n - 1, SOME_NAMES).round().astype(int)
        handles, texts = [handles[k] for k in some], [texts[k] for k in some]
        handles.append(plt.Line2D([], [], ls=""))
        texts.append(f"(some of {n})")
    small = {"fontsize": 8, "labelspacing": 0.2} if len(texts) > FEW_NAMES else {}
    axes.legend(handles, texts, loc="upper left", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.4, **small)


def _owner(curve: Curve) -> str:
    """ "ball" of bodies/ball/position; "energy" of energy/kinetic; "probe 3" of probes/3/p."""
    parts = curve.name.split("/")
    if len(parts) == 3 and parts[0] in ("probes", "planes"):
        return f"{parts[0][:-1]} {parts[1]}"
    return parts[-2] if len(parts) > 1 else ""
