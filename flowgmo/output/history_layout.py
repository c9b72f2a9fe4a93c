"""What history.h5 holds: one line per dataset. The contract with everyone who reads the file.

columns () for a number per row, (3,) for a vector ...; `source` is the field of `Rows`; `quantity` a key of units.unit.
"""

from __future__ import annotations

from dataclasses import dataclass

FORMAT = "flowgmo history"
FORMAT_VERSION = 1


@dataclass(frozen=True)
class Column:
    """One dataset (rows, *columns) and its attributes."""

    name: str
    source: str
    columns: tuple[int, ...]
    quantity: str
    location: str
    meaning: str


BODY = (
    Column("position", "p_WB", (3,), "length", "space axes", "position of the body's point"),
    Column("velocity", "v_WB", (3,), "velocity", "space axes, at the body's point", "velocity of the body's point"),
    Column(
        "orientation", "q_WB", (4,), "none", "body to space axes",
        "unit quaternion w x y z; body axes are space axes at t = 0; sign continuous",
    ),
    Column("angular_velocity", "w_WB", (3,), "spin", "space axes", "angular velocity"),
    Column("contact_force", "contact_force", (3,), "force", "space axes", "force of persistent contacts on the body"),
    Column(
        "residual_force", "residual_force", (3,), "force", "space axes",
        "force that keeps a prescribed motion, beyond gravity and control loads",
    ),
    Column(
        "residual_torque", "residual_torque", (3,), "torque", "space axes, about the body's point",
        "torque that keeps a prescribed motion, beyond control loads",
    ),
    Column("kinetic_energy", "kinetic_energy", (), "energy", "whole body", "kinetic energy of the body"),
)  # fmt: skip

ENERGY = {
    "kinetic": "kinetic energy of all bodies and the liquid",
    "potential": "potential energy in gravity",
    "dissipated": "lost in friction and viscosity since t = 0",
    "work_prescribed": "given by prescribed motions since t = 0",
    "work_loads": "given by control loads since t = 0",
    "work_boundaries": "given by the domain's boundaries since t = 0",
    "impacts": "lost in impacts since t = 0",
    "remainder": "what the books of energy miss",
}

#: What is recorded of the liquid: group -> dataset -> (columns, quantity, location, meaning). In the file a group is
#: `fluid`, `momentum`, `boundaries/<side>`, `planes/<k>`, `probes/<k>`, `bodies/<OBSID>`. `source` of such a Column is
#: its name.
LIQUID = {
    "fluid": {
        "volume": ((), "volume", "", "volume of the liquid"),
        "volume_error": ((), "none", "", "part that is too much (> 0) or missing, of start + inflow - outflow"),
        "kinetic_energy": ((), "energy", "", "kinetic energy of the liquid"),
        "potential_energy": ((), "energy", "", "of the liquid in gravity, from the corner of the domain it points at"),
        "wet_share": ((), "none", "", "cells that hold liquid, part of all"),
        "dissipated": ((), "energy", "", "lost in viscosity since t = 0, on walls too, films apart"),
        "work_boundaries": (
            (),
            "energy",
            "",
            "given by sides that slide, and by streams through open ones, since t = 0",
        ),
    },
    "momentum": {
        "total": ((3,), "impulse", "space axes", "momentum of the liquid and the coupled bodies"),
        "gravity": ((3,), "impulse", "space axes", "given by gravity since t = 0"),
        "walls": ((3,), "impulse", "space axes", "given by closed sides and solids that stand still since t = 0"),
        "prescribed": ((3,), "impulse", "space axes", "given to the liquid by prescribed bodies since t = 0"),
        "contacts": (
            (3,),
            "impulse",
            "space axes",
            "given to coupled bodies by contacts, stops and what keeps prescribed components since t = 0",
        ),
        "loads": ((3,), "impulse", "space axes", "given by control loads since t = 0"),
        "streams": ((3,), "impulse", "space axes", "given by open sides since t = 0"),
        "remainder": ((3,), "impulse", "space axes", "what the book of momentum misses"),
    },
    "boundaries": {"volume": ((), "volume", "this side", "liquid that came in since t = 0, < 0 what left")},
    "planes": {"flow": ((), "flow", "this plane", "volume of liquid per time, along the axis")},
    "probes": {
        "p": ((), "pressure", "at the probe", "pressure"),
        "u": ((), "velocity", "at the probe", "velocity along x; 0 where dry"),
        "v": ((), "velocity", "at the probe", "velocity along y; 0 where dry"),
        "w": ((), "velocity", "at the probe", "velocity along z; 0 where dry"),
        "F": ((), "none", "at the probe", "liquid fraction"),
        "height": ((), "length", "column of the probe", "z of the surface; of the floor where dry"),
    },
    "bodies": {
        "force": ((3,), "force", "space axes", "force of the liquid on the body, the void's pressure apart"),
        "torque": ((3,), "torque", "space axes, about the attribute `point` of the group", "torque of the liquid"),
        "force_pressure": ((3,), "force", "space axes", "part of the force that pressure makes"),
        "force_shear": ((3,), "force", "space axes", "part of the force that viscous shear makes"),
        "force_film": ((3,), "force", "space axes", "part of the force that films thinner than the mesh resolves make"),
        "wetted_area": ((), "area", "", "area of the wall that liquid touches"),
        "buoyancy_centre": (
            (3,),
            "length",
            "space axes",
            "centre of the displaced liquid, to the level at the body; dry: its point",
        ),
    },
}


def liquid_column(name: str, moving: tuple[str, ...] = ()) -> Column:
    """The dataset of a name such as `probes/3/p`; `name` of the Column is the whole of it. moving: names of bodies
    that move, of which loads are means over steps, and torques about their own points."""
    group, _, rest = name.partition("/")
    of, _, quantity_name = rest.rpartition("/")
    columns, quantity, location, meaning = LIQUID[group][quantity_name]
    if group == "bodies" and of in moving and quantity in ("force", "torque"):
        meaning += "; mean over the step that ends at the row or goes on at it, impacts apart"
        location = location if quantity == "force" else "space axes, about the body's point"
    return Column(name, name, columns, quantity, location, meaning)


#: Columns of one impact: name -> (columns, quantity, meaning). Types are those of records.IMPACT.
COLLISIONS = {
    "time": ((), "time", "time of the impact"),
    "a": ((), "none", "number of party a; component > 0, domain side < 0, stop 0"),
    "b": ((), "none", "number of party b; component > 0, domain side < 0, stop 0"),
    "point": ((3,), "length", "contact point"),
    "normal": ((3,), "none", "unit normal from b to a"),
    "impulse": ((3,), "impulse", "impulse on a"),
    "fluid_impulse": ((3,), "impulse", "impulse that the liquid around a and b gets at once, by its inertia"),
    "e": ((), "none", "coefficient of restitution"),
    "mu": ((), "none", "coefficient of friction"),
    "regime": ((), "none", "how the impact went; names in the attribute `names`"),
    "energy_loss": ((), "energy", "kinetic energy lost"),
    "cluster": ((), "none", "shared number of the contacts resolved together"),
    "count": ((), "none", "bounces that this row stands for"),
}
