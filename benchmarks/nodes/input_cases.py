"""Nodes that tell of the mesh, the object, the camera and the ray; and those that bend normals."""

from .case import Case

_GEOMETRY = ("Position", "Normal", "Tangent", "True Normal", "Incoming", "Backfacing")
_COORDINATES = (*("Generated", "Normal", "UV", "Object", "Camera", "Window", "Reflection"),)
_OBJECT = ("Location", "Color", "Alpha", "Object Index", "Material Index", "Random")
_RAY = ("Is Camera Ray", "Is Shadow Ray", "Ray Length", "Ray Depth", "Transparent Depth")


def _small(output):
    # What is some metres long is shown as a share of them.
    return output


CASES = [
    # Where a pixel lies on the edge of two triangles, either may be seen.
    *(Case("NewGeometry", name, shape="dome", exempt=0.06) for name in _GEOMETRY),
    Case("NewGeometry", "Pointiness", shape="dome"),
    Case("NewGeometry", "Parametric", exempt=0.2),
    Case("NewGeometry", "Parametric", shape="dome", exempt=0.1),
    Case("NewGeometry", "Random Per Island", shape="dome"),
    # An edge of a line may run through the middle of a pixel.
    *(Case("Wireframe", "Fac", {"Size": s}, exempt=0.06) for s in (0.3, 0.7)),
    Case("Wireframe", "Fac", {"Size": "signed"}, exempt=0.06),
    Case("Wireframe", "Fac", {"Size": 0.13}, shape="dome", exempt=0.1),
    *(
        Case("Wireframe", "Fac", {"Size": s}, {"use_pixel_size": True}, exempt=0.1)
        for s in (0.8, 1.5)
    ),
    *(Case("TexCoord", name, shape="dome") for name in _COORDINATES),
    *(Case("ObjectInfo", name) for name in _OBJECT),
    *(Case("CameraData", name) for name in ("View Vector", "View Z Depth", "View Distance")),
    *(Case("LightPath", name) for name in _RAY),
    *(Case("Fresnel", "Fac", {"IOR": ior}, shape="dome") for ior in (1.1, 1.45, 3.0, 0.7)),
    Case("Fresnel", "Fac", {"IOR": 1.4, "Normal": "bent"}),
    *(
        Case("LayerWeight", name, {"Blend": blend}, shape="dome")
        for name in ("Fresnel", "Facing")
        for blend in (0.2, 0.5, 0.8)
    ),
    Case("LayerWeight", "Facing", {"Blend": 0.3, "Normal": "bent"}),
    # As they are, not of unit length.
    *(Case("LayerWeight", n, {"Blend": 0.3, "Normal": "uv"}) for n in ("Facing", "Fresnel")),
    Case("Fresnel", "Fac", {"IOR": 1.4, "Normal": "signed"}),
    *(Case("Tangent", "Tangent", settings={"axis": axis}, shape="dome") for axis in "XYZ"),
    Case("Tangent", "Tangent", settings={"direction_type": "UV_MAP"}, shape="dome"),
    Case("UVMap", "UV"),
    Case("UVMap", "UV", settings={"uv_map": "UVMap"}),
    Case("Attribute", "Color", settings={"attribute_name": "Col"}),
    Case("Attribute", "Alpha", settings={"attribute_name": "Col"}),
    *(Case("Attribute", "Fac", settings={"attribute_name": n}) for n in ("Col", "UVMap")),
    Case("Attribute", "Vector", settings={"attribute_name": "UVMap"}),
    Case("VertexColor", "Color", settings={"layer_name": "Col"}),
    Case("VertexColor", "Alpha", settings={"layer_name": "Col"}),
    *(
        Case(
            "NormalMap",
            "Normal",
            {"Color": "color", "Strength": strength},
            {"space": space},
            shape="dome",
        )
        for space in ("TANGENT", "OBJECT", "WORLD", "BLENDER_OBJECT", "BLENDER_WORLD")
        for strength in (0.6, 1.0)
    ),
    Case("NormalMap", "Normal", {"Color": "color"}, {"convention": "DIRECTX"}, shape="dome"),
    Case("Bump", "Normal", {"Height": "x", "Distance": 1.0}),
    Case(
        "Bump",
        "Normal",
        {"Height": "y", "Strength": 0.4, "Distance": 0.5},
        {"invert": True},
        shape="dome",
    ),
    Case("Bump", "Normal", {"Height": "x", "Normal": "bent", "Distance": 0.5}),
    Case("Displacement", "Displacement", {"Height": "x", "Scale": 0.6}),
    Case("Displacement", "Displacement", {"Height": "y", "Scale": 0.4}, {"space": "WORLD"}),
    Case("Displacement", "Displacement", {"Height": "x", "Scale": 0.4}, shape="dome"),
    Case("VectorDisplacement", "Displacement", {"Vector": "uv"}, {"space": "WORLD"}),
    *(
        Case("LightFalloff", name, {"Strength": 0.02, "Smooth": 0.5})
        for name in ("Quadratic", "Linear", "Constant")
    ),
    *(
        Case("HairInfo", name)
        for name in ("Is Strand", "Intercept", "Length", "Thickness", "Random")
    ),
    *(Case("ParticleInfo", name) for name in ("Index", "Random", "Age", "Location", "Velocity")),
    *(Case("PointInfo", name) for name in ("Position", "Radius", "Random")),
    *(Case("VolumeInfo", name) for name in ("Color", "Density", "Flame")),
    Case("Normal", "Dot", {"Normal": "bent"}),
    *(
        Case(
            "VectorRotate",
            "Vector",
            {"Vector": "signed", "Center": (0.1, 0.2, 0.3)}
            | ({"Rotation": (0.3, 0.5, 0.8)} if kind == "EULER_XYZ" else {"Angle": 0.8})
            | ({"Axis": (1.0, 2.0, 0.5)} if kind == "AXIS_ANGLE" else {}),
            {"rotation_type": kind, "invert": invert},
        )
        for kind in ("AXIS_ANGLE", "X_AXIS", "Y_AXIS", "Z_AXIS", "EULER_XYZ")
        for invert in (False, True)
    ),
    *(
        Case(
            "VectorTransform",
            "Vector",
            {"Vector": "signed"},
            {"vector_type": kind, "convert_from": start, "convert_to": end},
        )
        for kind in ("POINT", "VECTOR", "NORMAL")
        for start, end in (
            ("WORLD", "OBJECT"),
            ("OBJECT", "WORLD"),
            ("CAMERA", "WORLD"),
            ("OBJECT", "CAMERA"),
        )
    ),
]
