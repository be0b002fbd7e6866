"""Materials that are seen as they are, so that few samples are enough."""


def emission(bpy, name, color=(1.0, 1.0, 1.0), strength=1.0, attribute=None):
    """Return a material that glows evenly.

    Parameters
    ----------
    bpy : module
    name : str
    color : tuple of 3 float
    strength : float
    attribute : str, optional
        Name of a colour attribute whose colour is taken instead.

    Returns
    -------
    bpy.types.Material
    """
    material = bpy.data.materials.new(name)
    tree = material.node_tree
    tree.nodes.clear()
    glow = tree.nodes.new("ShaderNodeEmission")
    glow.inputs["Color"].default_value = (*color, 1.0)
    glow.inputs["Strength"].default_value = strength
    if attribute is not None:
        node = tree.nodes.new("ShaderNodeVertexColor")
        node.layer_name = attribute
        tree.links.new(node.outputs["Color"], glow.inputs["Color"])
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(glow.outputs["Emission"], output.inputs["Surface"])
    return material
