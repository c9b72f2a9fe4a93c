"""Deck -> Model. Deck names end here: one file for each part of the Model."""

from flowgmo.building.build import build_model

__all__ = ["build_model"]
