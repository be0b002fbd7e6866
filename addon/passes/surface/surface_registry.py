"""Generators of GLSL by the kind of `ShaderNode` that they are for."""


def generator_registry():
    """Make a registry and the decorator that fills it.

    Returns
    -------
    generators : dict of str to callable
    generates : callable
        ``@generates("kind")``.
    """
    generators = {}

    def generates(kind):
        def register(function):
            generators[kind] = function
            return function

        return register

    return generators, generates
