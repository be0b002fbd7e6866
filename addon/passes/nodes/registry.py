"""Generators of GLSL by the kind of `ShaderNode` that they are for."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Generator:
    """How the code of a kind of node is written.

    Parameters
    ----------
    write : callable
        Takes the `ShaderNode` and a `Writer`; returns the type and expression of each output by the
        socket's name in the graph. Types are GLSL's, and ``"color"`` for a vec3 that converts to a
        number as its luminance.
    libraries : tuple of str
        Shader files below ``gpu_shaders/`` that the code calls.
    """

    write: object
    libraries: tuple[str, ...] = ()


def generator_registry():
    """Make a registry and the decorator that fills it.

    Returns
    -------
    generators : dict of str to Generator
    generates : callable
        ``@generates("kind", *libraries)``.
    """
    generators = {}

    def generates(kind, *libraries):
        def register(function):
            generators[kind] = Generator(function, libraries)
            return function

        return register

    return generators, generates
