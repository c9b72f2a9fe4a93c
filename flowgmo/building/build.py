"""build_model: all parts together, and all problems of all parts together."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flowgmo.building.bodies import build_body
from flowgmo.building.contacts import build_contacts
from flowgmo.building.domain import build_mesh
from flowgmo.building.effects import list_effects
from flowgmo.building.findings import Findings
from flowgmo.building.fluid import build_fluid
from flowgmo.building.times import build_clock, build_output
from flowgmo.building.wet_bodies import with_least_mass
from flowgmo.deck import Deck, DeckError
from flowgmo.model import Model


def build_model(deck: Deck, folder: Path | None = None) -> Model:
    """The Model of a deck that has been read. Raises DeckError with everything that is wrong.

    folder: where results will go; file names in the resolved deck are relative to it.
    """
    found = Findings(deck)
    clock = build_clock(found)
    output = build_output(found, clock)
    mesh = build_mesh(found)
    if found.problems:
        raise DeckError(found.problems, found.notices)
    bodies = tuple(build_body(found, m, mesh.bounds) for m in range(1, int(deck["NOBS"]) + 1))
    if found.problems:
        raise DeckError(found.problems, found.notices)
    bodies = with_least_mass(found, mesh, bodies)
    contacts = build_contacts(found, bodies, mesh)
    fluid = build_fluid(found, mesh, bodies)
    if found.problems:
        raise DeckError(found.problems, found.notices)
    return Model(
        title=deck.title,
        stem=deck.path.stem,
        units=str(deck["UNITS"] or ""),
        resolved_deck=deck.resolved(folder),
        clock=clock,
        output=output,
        gravity=np.array([deck["GX"], deck["GY"], deck["GZ"]], dtype=float),
        mesh=mesh,
        bodies=bodies,
        contacts=contacts,
        effects=list_effects(deck, bodies, contacts, fluid),
        fluid=fluid,
        notices=tuple(str(notice) for notice in found.notices),
    )
