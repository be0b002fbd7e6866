"""Which attributes of a mesh a material bends: turns into light by more than a linear function.

A mean of a linear function is the function of the mean, so a surface may be smoothed as long as it
keeps the means of its attributes. A slope through a colour ramp, a mask through a threshold or a
normal that looks up an image is another matter: see `bent_levels`.
"""

from ..snapshot.surface_graph import LIT_KINDS, Constant, Link

# Outputs that tell of the normal, by the kind of their node; how closures are lit is not asked
# here: the errors of levels count it.
_NORMALS = {
    "geometry": frozenset({"Normal", "True Normal", "Tangent"}),
    "texture_coordinate": frozenset({"Normal", "Reflection"}),
    "tangent": frozenset({"Tangent"}),
}
# Kinds that are no linear function of the normal by themselves.
_BENDING = frozenset({"fresnel", "layer_weight"})
_MATH_OF_ONE = frozenset({"MULTIPLY", "MULTIPLY_ADD", "SCALE", "DOT_PRODUCT"})
_SUMS = frozenset({"ADD", "SUBTRACT"})
_JOINING = frozenset(
    {"affine", "bump", "normal_map", "luminance", "add_shader", "vector_transform"}
)
# Inputs of closures: colours, which light is a sum of, and their factors.
_COLORS = frozenset({"Color", "Base Color", "Emission Color"})
_STRENGTHS = frozenset({"Strength", "Emission Strength"})
_CLOSURES = LIT_KINDS | {"emission"}


def bent_attributes(graph):
    """Return the attributes of a mesh whose distribution decides how much light there is.

    Parameters
    ----------
    graph : SurfaceGraph

    Returns
    -------
    frozenset of str
        Of the keys of `surface_graph.attributes_read`: ``"normal"``, ``"pointiness"`` and
        ``"color:NAME"``.
    """
    carried, bent = [], set()
    for node in graph.nodes:
        inputs = {
            name: carried[source.node] | _read(graph.nodes[source.node], source.output)
            for name, source in node.inputs
            if isinstance(source, Link)
        }
        inputs = {name: keys for name, keys in inputs.items() if keys}
        if node.kind in _CLOSURES:
            # A bent normal of a closure is lit as any other.
            inputs.pop("Normal", None)
        keys = frozenset().union(*inputs.values())
        if node.kind in _BENDING:
            bent.add("normal")
        if not _is_linear(node, inputs):
            bent |= keys
        # What light is made of has arrived.
        carried.append(frozenset() if node.kind in _CLOSURES else keys)
    return frozenset(bent)


def _read(node, output):
    """Return what the output of a node reads of the mesh."""
    if output in _NORMALS.get(node.kind, ()):
        return frozenset({"normal"})
    if node.kind == "pointiness":
        return frozenset({"pointiness"})
    if node.kind in {"color_attribute", "attribute"}:
        return frozenset({f"color:{node.setting('name')}"})
    return frozenset()


def _is_linear(node, inputs):
    """Whether a node is a linear function of those of its inputs that read the mesh."""
    if not inputs or node.kind in _JOINING:
        return True
    if node.kind in _CLOSURES:
        return inputs.keys() <= _COLORS or (len(inputs) == 1 and inputs.keys() <= _STRENGTHS)
    if node.kind in {"separate", "combine"}:
        return node.setting("model") in {"XYZ", "RGB"}
    if node.kind in {"math", "vector_math"}:
        return _is_linear_math(node, inputs)
    if node.kind in {"mix_color", "mix_value"}:
        plain = node.setting("blend", "MIX") == "MIX" and not node.setting("clamp_result")
        return plain and isinstance(node.input("factor"), Constant)
    return False


def _is_linear_math(node, inputs):
    operation = node.setting("operation")
    if node.setting("clamp"):
        return False
    if operation in _SUMS:
        return True
    if operation == "DIVIDE":
        return inputs.keys() == {"a"}
    # A product with something that does not vary over the mesh by itself.
    return operation in _MATH_OF_ONE and len(inputs.keys() - {"c"}) <= 1
