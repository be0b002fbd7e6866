"""What is drawn of nodes that give light instead of numbers, and of those that are not drawn."""

EXACT, APPROXIMATE, FALLBACK = "exact", "approximate", "fallback"

_FOG = "the same all over the box around its mesh, in front of what is in it; scatters light once"

# By Blender's type without ``ShaderNode``. Closures are compared with Cycles on lit spheres, in
# tests/render/against_cycles/test_surfaces_against_cycles.py.
STATED = {
    "AddShader": (EXACT, ""),
    "MixShader": (EXACT, ""),
    "Emission": (EXACT, ""),
    "Background": (EXACT, "of a world; see below"),
    "Holdout": (EXACT, ""),
    "OutputMaterial": (EXACT, "Surface; Displacement as bump; Volume where there is no Surface"),
    "OutputWorld": (EXACT, "Surface; no Volume"),
    "OutputLight": (APPROXIMATE, "one Emission of constant inputs"),
    "BsdfTransparent": (EXACT, "shadows of coloured ones are grey"),
    "BsdfDiffuse": (APPROXIMATE, "no light from other surfaces"),
    "BsdfAnisotropic": (APPROXIMATE, "mirrors lights and the world; no anisotropy"),
    "BsdfPrincipled": (
        APPROXIMATE,
        "all but anisotropy and thin film; glass as of Glass BSDF; light below the surface leaves"
        " where it enters",
    ),
    "BsdfMetallic": (APPROXIMATE, "edges of conductors by Schlick; no anisotropy, no thin film"),
    "BsdfGlass": (APPROXIMATE, "bends light at its front and its farthest back; see below"),
    "BsdfRefraction": (APPROXIMATE, "bends light at its front and its farthest back; see below"),
    "BsdfTranslucent": (APPROXIMATE, "of lights and the world"),
    "SubsurfaceScattering": (APPROXIMATE, "light leaves where it enters: a diffuse surface"),
    "BsdfSheen": (APPROXIMATE, "fibres scatter the light of lamps as a diffuse surface does"),
    "BsdfToon": (APPROXIMATE, "the world as a diffuse surface reflects it"),
    "BsdfHair": (
        APPROXIMATE,
        "on meshes along the UV map's tangent, in Cycles by triangles; no offset",
    ),
    "BsdfHairPrincipled": (
        APPROXIMATE,
        "the colour of many strands, half of its light from behind, with a highlight; Cycles'"
        " single strands are brighter",
    ),
    "BsdfRayPortal": (APPROXIMATE, "what is straight behind; light is not taken elsewhere"),
    "EeveeSpecular": (APPROXIMATE, "as EEVEE draws it, without clear coat; Cycles draws nothing"),
    "AmbientOcclusion": (FALLBACK, "its colour; AO is 1"),
    "Bevel": (FALLBACK, "the normal as it is"),
    "Raycast": (FALLBACK, "the value of the socket that it feeds"),
    "OutputAOV": (FALLBACK, "no such pass"),
    "VolumeAbsorption": (APPROXIMATE, _FOG),
    "VolumeCoefficients": (APPROXIMATE, _FOG),
    "VolumePrincipled": (APPROXIMATE, _FOG),
    "VolumeScatter": (APPROXIMATE, _FOG),
}

# Reasons and limits of nodes that are measured.
LIMITS = {
    "TexIES": "type C photometry",
    "TexSky": "single and multiple scattering with a disc: by generated coordinates, as in Cycles",
    "RadialTiling": "corners neither sharp nor round: up to 0.03 off",
    "Script": "as Cycles without OSL: the value of the socket that it feeds",
    "ShaderToRGB": "as Cycles, which has none: the value of the socket that it feeds",
    "NewGeometry": "other islands than the first have other random numbers",
    "TexCoord": "Window of the drawn region; not from an instancer",
    "LightPath": "as a ray from the camera sees it",
    "Attribute": "of the mesh; not of objects, instancers and view layers",
    "Bump": "slopes from pixel to pixel",
    "Displacement": "as bump; vertices stay",
    "VectorDisplacement": "as bump; vertices stay",
    "NormalMap": "in tangent space of meshes of triangles and quads",
    "TexImage": "no mipmaps",
    "Mix": "not of rotations",
    "HairInfo": "of meshes",
    "ParticleInfo": "of meshes that are no particles",
    "PointInfo": "of meshes",
    "VolumeInfo": "of surfaces",
    "LightFalloff": "of materials",
}
# No nodes of materials and worlds that an artist adds: bases, groups, Freestyle, and old ones that
# Blender makes into others.
NOT_IN_THE_MENU = {
    *("", "Tree", "CustomGroup", "Group", "OutputLineStyle", "UVAlongStroke", "Squeeze"),
}
