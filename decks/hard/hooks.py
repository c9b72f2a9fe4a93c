"""Write hook.stl: a hook of round wire, a six-sided tube along a straight shank and two thirds of a circle.

    python decks/hard/hooks.py

The circle lies in the plane y = 0 around the origin, its opening above; the shank rises from its right end. Of every
hexagon one corner points to the middle of the circle, so that the inside of the bend is an edge: two hooks that hang
in each other touch in a point.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

BEND, WIRE = 0.03, 0.008  # radius of the circle, of the wire [m]
SHANK = 0.08  # [m]
SIDES, STEPS = 6, 16  # of the wire; of the bend, 15 degrees each: a tip at 240 degrees keeps the opening wide


def rings() -> np.ndarray:
    """Cross-sections (k, SIDES, 3) from the top of the shank around the bend to the tip."""
    angles = np.radians(-15.0 * np.arange(STEPS + 1))
    inward = -np.stack([np.cos(angles), np.zeros_like(angles), np.sin(angles)], axis=1)
    centres = -BEND * inward
    top = np.array([[BEND, 0.0, SHANK]])
    centres, inward = np.concatenate([top, centres]), np.concatenate([inward[:1], inward])
    corner = 2.0 * np.pi / SIDES * np.arange(SIDES)[:, None]
    offsets = np.cos(corner) * inward[:, None, :] + np.sin(corner) * np.array([0.0, 1.0, 0.0])
    return centres[:, None, :] + WIRE * offsets


def triangles(ring: np.ndarray) -> np.ndarray:
    """Corners (f, 3, 3) of the closed tube through the rings, outward."""
    faces = []
    for one, two in zip(ring[:-1], ring[1:], strict=True):
        for k in range(SIDES):
            m = (k + 1) % SIDES
            faces += [(one[k], two[m], one[m]), (one[k], two[k], two[m])]
    for k in range(1, SIDES - 1):
        faces += [(ring[0, 0], ring[0, k], ring[0, k + 1]), (ring[-1, 0], ring[-1, k + 1], ring[-1, k])]
    corners = np.array(faces)
    volume = np.einsum("fi,fi->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    return corners if volume > 0.0 else corners[:, ::-1]


def main() -> None:
    """Write the file beside this one."""
    lines = ["solid hook"]
    for face in triangles(rings()):
        normal = np.cross(face[1] - face[0], face[2] - face[0])
        lines.append("facet normal {:.6f} {:.6f} {:.6f}".format(*(normal / np.linalg.norm(normal))))
        lines += ["outer loop", *("vertex {:.9f} {:.9f} {:.9f}".format(*x) for x in face), "endloop", "endfacet"]
    lines.append("endsolid hook")
    (Path(__file__).parent / "hook.stl").write_text("\n".join(lines) + "\n", encoding="ascii")


if __name__ == "__main__":
    main()
