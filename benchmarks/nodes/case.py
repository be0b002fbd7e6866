"""One way to use a node, of which a picture is compared with Cycles."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Case:
    """A node with its inputs, settings and the output that is shown.

    Parameters
    ----------
    node : str
        Blender's type without ``ShaderNode``: ``"TexNoise"``.
    output : str
        Name or identifier of a socket.
    inputs : dict of str to object
        By the socket's name or identifier: a number, a tuple, or a string that names a source of
        values: ``"uv"``, ``"object"``, ``"place"`` (world space), ``"x"`` (a number from 0 to 1
        along the card), ``"y"``, ``"signed"`` (a vector from -2 to 2),
        ``"steps"`` (the same in whole numbers), ``"color"`` (of an image),
        ``"bent"`` (a unit vector near the normal), ``"straight up"``, ``"nowhere"``
        (a vector of zeros).
    settings : dict of str to object
        Properties of the node.
    prepare : callable or None
        Called with bpy and the node, for what is no simple property.
    shape : {'card', 'dome'}
        What the surface is.
    exempt : float
        Share of the pixels that may differ: where a step of the function lies at the pixel's own
        value, rounding decides.
    gain : float
        What is shown is multiplied by it, where it is brighter than a picture.
    reason : str
        Why it is not exact, for the docs.
    """

    node: str
    output: str
    inputs: dict = field(default_factory=dict)
    settings: dict = field(default_factory=dict)
    prepare: object = None
    shape: str = "card"
    exempt: float = 0.0
    gain: float = 1.0
    reason: str = ""

    @property
    def name(self):
        """What tells it from others of the same node."""
        words = [f"{key} {value}" for key, value in self.settings.items()]
        words += [f"{key} {value}" for key, value in self.inputs.items()]
        return f"{self.node}.{self.output} " + ", ".join(words)
