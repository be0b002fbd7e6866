"""Cache keys of what the look of a frame's discs is made of."""

from .lens_profiles import lens_profile


class LensKey:
    """A real lens as a cache key; its prescription is compared by identity."""

    def __init__(self, settings):
        self.settings = settings

    def __eq__(self, other):
        """Whether both make the same."""
        return self.settings == other.settings

    def __hash__(self):
        """Return a number that equal keys share."""
        return hash((self.settings.id, self.settings.label, self.settings.f_number))

    def profile(self):
        """Return the lens' bokeh profile."""
        return lens_profile(self.settings)


class ArraysKey:
    """Arrays as a cache key: compared by identity, not by value."""

    def __init__(self, *parts):
        self.parts = parts

    def __eq__(self, other):
        """Whether both make the same."""
        return len(self.parts) == len(other.parts) and all(
            a is b for a, b in zip(self.parts, other.parts, strict=True)
        )

    def __hash__(self):
        """Return a number that equal keys share."""
        return hash(tuple(map(id, self.parts)))
