"""What decks/hard is about, per deck; called by decks/measure.py."""

from __future__ import annotations

import numpy as np
from curves import Curves, after_hit, body_axes, drift, energy_added


def jam(curves: Curves) -> dict[str, float]:
    angle = np.radians(64.0)
    velocity, spin = (after_hit(curves, 1, "rod", quantity) for quantity in ("velocity", "angular_velocity"))
    tip = velocity + np.cross(spin, -0.5 * np.array([np.cos(angle), 0.0, np.sin(angle)]))
    return {"tip x": tip[0], "tip z": tip[2]}


def locks(curves: Curves) -> dict[str, float]:
    """The tip from the spin alone: the arm starts at the fixed point, which stands still."""
    arm, found = -np.sqrt(0.5) * np.array([1.0, 0.0, 1.0]), {}
    for number, rod in enumerate(("slides", "locks", "halts", "rebounds"), start=1):
        tip = np.cross(after_hit(curves, number, rod, "angular_velocity"), arm)
        found |= {f"tip {axis} of {rod}": value for axis, value in zip("xyz", tip, strict=True)}
    return found


def rebound(curves: Curves, body: str) -> dict[str, float]:
    return {
        "rebound": curves.at(body, "velocity")[2],
        "spin": np.linalg.norm(curves.at(body, "angular_velocity")),
    }


def pegs(curves: Curves) -> dict[str, float]:
    """Contacts of the landing: rows of the first cluster."""
    cluster = curves.impacts["cluster"]
    return rebound(curves, "plate") | {"contacts": np.sum(cluster == cluster[0])}


def plate(curves: Curves) -> dict[str, float]:
    """Rows in which a shot is beyond the middle of its plate; the normal of the free one turns with it."""
    shot, free = curves.bodies["shot_free"]["position"], curves.bodies["free"]
    away = body_axes(free["orientation"], shot - free["position"])[:, 0]
    return {
        "rebound of shot": curves.at("shot", "velocity")[0],
        "rows beyond": np.sum(curves.bodies["shot"]["position"][:, 0] > 0.005) + np.sum(away > 0.0),
    }


def hooks(curves: Curves) -> dict[str, float]:
    """Rows in which the middles of the two bends are two radii apart: circles hang in each other only within that."""
    body, start = curves.bodies["lower"], np.array([0.0, 0.0, -0.0438])
    back = body["orientation"] * [1.0, -1.0, -1.0, -1.0]
    middle = body["position"] + body_axes(back, np.broadcast_to(start - body["position"][0], body["position"].shape))
    return {"rows apart": np.sum(np.linalg.norm(middle, axis=1) >= 2.0 * 0.03)}


def kept(curves: Curves) -> dict[str, float]:
    return {"change of energy": np.abs(curves.energy["kinetic"] / curves.energy["kinetic"][0] - 1.0).max()}


HARD = {
    "heavy": lambda curves: {"drift": drift(curves, ("light", "heavy"), 0.1)},
    "gas": kept,
    "tumble": kept,
    "cradle": lambda curves: {f"velocity of {ball}": curves.at(ball, "velocity")[0] for ball in curves.bodies},
    "flat": lambda curves: rebound(curves, "box"),
    "pegs": pegs,
    "jam": jam,
    "locks": locks,
    "coin": lambda curves: {"depth": max(0.001 - curves.bodies["coin"]["position"][:, 2].min(), 0.0)},
    "plate": plate,
    "bar": lambda curves: {"rows beyond": np.sum(curves.bodies["bar"]["position"][:, 0] > 0.0)},
    "cells": lambda curves: {f"height of {body}": curves.at(body, "position")[2] for body in curves.bodies},
    "corner": lambda curves: {"way of box": np.linalg.norm(np.ptp(curves.bodies["box"]["position"][[0, -1]], axis=0))},
    "hooks": hooks,
}


def hard(curves: Curves, deck: str) -> dict[str, float]:
    found = {"energy added": energy_added(curves)}
    return found | HARD[deck](curves) if deck in HARD else found
