"""Registry of all shader variants, so that a test can compile and bind every one.

A function that makes a `ShaderInfo` for a choice of features is marked with `variants`, which names
the values that its arguments may have. The registry is not used to render.
"""

from itertools import product

_makers = []


def variants(allowed=None, **choices):
    """Mark a function that makes shader infos with the values that its arguments may have.

    Parameters
    ----------
    allowed : callable, optional
        Takes the arguments and tells whether they are ever asked for together.
    **choices : iterables
        Values by argument. An argument that is only a count or an index needs a value or two.
    """

    def mark(make):
        _makers.append((make, allowed, {name: tuple(values) for name, values in choices.items()}))
        return make

    return mark


def marked():
    """Return the marked functions, as ``module.function``."""
    return {f"{make.__module__}.{make.__qualname__}" for make, _, _ in _makers}


def every_info():
    """Yield the infos that marked functions make, each with a line that says how it was made."""
    for make, allowed, choices in _makers:
        for values in product(*choices.values()):
            arguments = dict(zip(choices, values, strict=True))
            if allowed is None or allowed(**arguments):
                yield f"{make.__module__}.{make.__qualname__}({arguments})", make(**arguments)
