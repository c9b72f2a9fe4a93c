"""The table of a report: the first rebounds of a bouncing body, else the first impacts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib import pyplot as plt

from postproc import style
from postproc.bounces import bouncing_body, rebounds
from postproc.impacts import hits
from postproc.palette import FAINT, INK
from postproc.results import Results

MOST_ROWS = 10
LONGEST = 10  # letters of a name
LETTERS, GAP = 10.5, 0.22  # font size; inches beside the text of a cell


@dataclass(frozen=True)
class Table:
    """Title, heads of the columns, cells."""

    title: str
    heads: list[str]
    rows: list[list[str]]

    @property
    def widths(self) -> np.ndarray:
        """Widths of the columns [inches] that heads and cells ask for."""
        columns = zip(self.heads, *self.rows, strict=True)
        return np.array(
            [GAP + max(style.text_width(text, LETTERS, k == 0) for k, text in enumerate(column)) for column in columns]
        )


def draw_table(axes: plt.Axes, results: Results, width: float) -> None:
    """Fill the axes, `width` inches wide, with it; in smaller letters where it asks for more."""
    axes.set_axis_off()
    body = bouncing_body(results)
    table = None if body is None else rebound_rows(results, body)
    table = table or impact_rows(results)
    rows, widths = table.rows, table.widths
    axes.set_title(style.plain(table.title))
    drawn = axes.table(
        cellText=[[style.plain(text) for text in row] for row in rows],
        colLabels=table.heads,
        loc="upper center",
        cellLoc="right",
        colLoc="right",
        edges="horizontal",
        colWidths=list(widths / widths.sum()),
    )
    drawn.auto_set_font_size(False)
    gaps = GAP * len(widths)
    drawn.set_fontsize(LETTERS * min(1.0, (width - gaps) / (widths.sum() - gaps)))
    drawn.scale(1, min(1.5, 16.0 / (len(rows) + 1)))
    for (row, _), cell in drawn.get_celld().items():
        cell.set_edgecolor(INK if row == 0 else FAINT)
        cell.set_text_props(fontweight="bold" if row == 0 else "normal")


def rebound_rows(results: Results, body: str) -> Table | None:
    """The first rebounds; None where the body came to no top."""
    length = style.unit_text(results.curve(f"bodies/{body}/position").unit)
    time = style.unit_text(results.time_unit)
    found = rebounds(results, body)
    if all(np.isnan(bounce.top) for bounce in found):
        return None
    more = f" (first {MOST_ROWS} of {len(found)})" if len(found) > MOST_ROWS else ""
    rows = [
        [str(k), *("–" if np.isnan(x) else f"{x:.5f}" for x in (bounce.impact, bounce.top, bounce.height))]
        for k, bounce in enumerate(found[:MOST_ROWS], start=1)
    ]
    heads = ["i", f"impact [{time}]", f"top [{time}]", f"height [{length}]"]
    return Table(f"Rebounds of {body}{more}", heads, rows)


def impact_rows(results: Results) -> Table:
    """The first hits, and the largest where it is not among them; the numbers of a column have the same decimals."""
    found, names = hits(results), results.parties
    size = found.size
    shown = np.arange(min(len(found), MOST_ROWS))
    largest = int(size.argmax())
    title = "Impacts"
    if len(found) > MOST_ROWS:
        title = f"Impacts (first {MOST_ROWS} of {len(found)})"
        if largest >= MOST_ROWS:
            shown = np.append(shown[:-1], largest)
            title = f"Impacts (first {MOST_ROWS - 1} of {len(found)}; below: largest)"
    a, b = (
        [style.short(names.get(int(number), str(number)), LONGEST) for number in party[shown]]
        for party in (found.a, found.b)
    )
    points = [str(n) for n in found.points[shown]]
    columns = [aligned(found.time[shown], 5), a, b, points, aligned(size[shown], 4)]
    unit = str(results.file["collisions/impulse"].attrs.get("unit", ""))
    heads = [style.label("time", results.time_unit), "a", "b", "points", style.label("impulse", unit)]
    rows = [list(row) for row in zip(*columns, strict=True)]
    return Table(title, heads, rows)


def aligned(values: np.ndarray, digits: int) -> list[str]:
    """Numbers with the decimals that give the middle one of them so many digits."""
    sizes = np.abs(values)[values != 0]
    if len(sizes) == 0:
        return ["0"] * len(values)
    decimals = digits - 1 - int(np.floor(np.log10(np.median(sizes)) + 1e-9))  # 1e-9: rounding of a 0.1
    if not 0 <= decimals <= digits + 3:
        return [f"{value:.{digits}g}" for value in values]
    return [f"{value:.{decimals}f}" for value in values]
