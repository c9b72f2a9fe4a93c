"""The table of a report: the first rebounds of a bouncing body, else the first impacts."""

from __future__ import annotations

import numpy as np
from matplotlib import pyplot as plt

from postproc import style
from postproc.bounces import bouncing_body, rebounds
from postproc.palette import FAINT, INK
from postproc.results import Results

MOST_ROWS = 10
LONGEST = 10  # letters of a name


def draw_table(axes: plt.Axes, results: Results) -> None:
    """Fill the axes with it."""
    axes.set_axis_off()
    body = bouncing_body(results)
    title, heads, rows = impact_rows(results) if body is None else rebound_rows(results, body)
    axes.set_title(style.plain(title))
    drawn = axes.table(
        cellText=[[style.plain(text) for text in row] for row in rows],
        colLabels=heads,
        loc="upper center",
        cellLoc="right",
        colLoc="right",
        edges="horizontal",
        colWidths=[0.1, 0.3, 0.3, 0.3] if body is not None else [0.2, 0.24, 0.24, 0.32],
    )
    drawn.auto_set_font_size(False)
    drawn.set_fontsize(10.5)
    drawn.scale(1, min(1.5, 16.0 / (len(rows) + 1)))
    for (row, _), cell in drawn.get_celld().items():
        cell.set_edgecolor(INK if row == 0 else FAINT)
        cell.set_text_props(fontweight="bold" if row == 0 else "normal")


def rebound_rows(results: Results, body: str) -> tuple[str, list[str], list[list[str]]]:
    """Title, heads, and cells."""
    length = style.unit_text(results.curve(f"bodies/{body}/position").unit)
    time = style.unit_text(results.time_unit)
    found = rebounds(results, body)
    more = f" (first {MOST_ROWS} of {len(found)})" if len(found) > MOST_ROWS else ""
    rows = [
        [str(k), *("–" if np.isnan(x) else f"{x:.5f}" for x in (bounce.impact, bounce.top, bounce.height))]
        for k, bounce in enumerate(found[:MOST_ROWS], start=1)
    ]
    return (
        f"Rebounds of {body}{more}",
        ["i", f"impact [{time}]", f"top [{time}]", f"height [{length}]"],
        rows,
    )


def impact_rows(results: Results) -> tuple[str, list[str], list[list[str]]]:
    """Title, heads, and cells; the numbers of a column have the same decimals."""
    impacts, names = results.impacts, results.parties
    order = np.argsort(impacts["time"], kind="stable")[:MOST_ROWS]
    impulse = np.linalg.norm(impacts["impulse"], axis=1)
    parties = [
        [style.short(names.get(int(number), str(number)), LONGEST) for number in impacts[side][order]] for side in "ab"
    ]
    columns = [aligned(impacts["time"][order], 5), *parties, aligned(impulse[order], 4)]
    count = len(impulse)
    unit = results.file["collisions/impulse"].attrs.get("unit", "")
    title = f"Impacts (first {MOST_ROWS} of {count})" if count > MOST_ROWS else "Impacts"
    heads = [style.label("time", results.time_unit), "a", "b", style.label("impulse", str(unit))]
    return title, heads, [list(row) for row in zip(*columns, strict=True)]


def aligned(values: np.ndarray, digits: int) -> list[str]:
    """Numbers with the decimals that give the largest of them so many digits."""
    largest = float(np.abs(values).max(initial=0.0))
    if largest == 0:
        return ["0"] * len(values)
    decimals = digits - 1 - int(np.floor(np.log10(largest) + 1e-9))  # 1e-9: rounding of a 0.1
    if not 0 <= decimals <= digits + 3:
        return [f"{value:.{digits}g}" for value in values]
    return [f"{value:.{decimals}f}" for value in values]
