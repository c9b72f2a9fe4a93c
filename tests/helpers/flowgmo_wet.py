"""A wet deck to vary: a box of 2 x 1 x 1.5 with 20 x 10 x 15 cells, half full."""

FREE = "twfin=2., itb=1, gz=-9.81,"
FULL = "twfin=2., gz=-9.81,"
MESH = "px=0., 2., nxcelt=20, py=0., 1., nycelt=10, pz=0., 1.5, nzcelt=15,"


def wet(xput=FREE, props="rhof=1000.,", fl="flht=.5,", mesh=MESH, **blocks):
    """The deck's text; one assignment a line, &xput from line 3, &props from the line after it, and so on."""
    text = "t\n"
    for name, body in {"xput": xput, "props": props, "mesh": mesh, "fl": fl, **blocks}.items():
        text += f"&{name}\n{body}\n/\n"
    return text
