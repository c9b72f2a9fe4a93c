"""The one exception of this package."""


class GeometryError(ValueError):
    """A shape that cannot be: the text says what is wrong and, where possible, what to write instead.

    Whoever knows the line of the deck adds it.
    """
