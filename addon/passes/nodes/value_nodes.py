"""Generators of GLSL for nodes that compute numbers, vectors and colours."""

from .registry import generator_registry

GENERATORS, generates = generator_registry()

_MATH = "lib/nodes/math_nodes_lib.glsl"
_COLOR = "lib/nodes/color_nodes_lib.glsl"

# Math operations as GLSL of a, b and c, which are variables.
MATH = {
    "ADD": "a + b",
    "SUBTRACT": "a - b",
    "MULTIPLY": "a * b",
    "DIVIDE": "math_safe_divide(a, b)",
    "MULTIPLY_ADD": "a * b + c",
    "POWER": "math_power(a, b)",
    "LOGARITHM": "math_logarithm(a, b)",
    "SQRT": "sqrt(max(a, 0.0))",
    "INVERSE_SQRT": "((a > 0.0) ? inversesqrt(a) : 0.0)",
    "ABSOLUTE": "abs(a)",
    "EXPONENT": "exp(a)",
    "MINIMUM": "min(a, b)",
    "MAXIMUM": "max(a, b)",
    "LESS_THAN": "float(a < b)",
    "GREATER_THAN": "float(a > b)",
    "SIGN": "sign(a)",
    "COMPARE": "math_compare(a, b, c)",
    "SMOOTH_MIN": "math_smooth_min(a, b, c)",
    "SMOOTH_MAX": "math_smooth_max(a, b, c)",
    "ROUND": "floor(a + 0.5)",
    "FLOOR": "floor(a)",
    "CEIL": "ceil(a)",
    "TRUNC": "trunc(a)",
    "FRACT": "fract(a)",
    "MODULO": "math_modulo(a, b)",
    "FLOORED_MODULO": "math_floored_modulo(a, b)",
    "WRAP": "math_wrap(a, b, c)",
    "SNAP": "math_snap(a, b)",
    "PINGPONG": "math_pingpong(a, b)",
    "SINE": "sin(a)",
    "COSINE": "cos(a)",
    "TANGENT": "tan(a)",
    "ARCSINE": "asin(clamp(a, -1.0, 1.0))",
    "ARCCOSINE": "acos(clamp(a, -1.0, 1.0))",
    "ARCTANGENT": "atan(a)",
    "ARCTAN2": "((a != 0.0 || b != 0.0) ? atan(a, b) : 0.0)",
    "SINH": "sinh(a)",
    "COSH": "cosh(a)",
    "TANH": "tanh(clamp(a, -20.0, 20.0))",
    "RADIANS": "radians(a)",
    "DEGREES": "degrees(a)",
}

# Those of vectors; `scale` is a number. The ones that give a number are named apart.
VECTOR_MATH = {
    "ADD": "a + b",
    "SUBTRACT": "a - b",
    "MULTIPLY": "a * b",
    "DIVIDE": "safe_divide(a, b)",
    "MULTIPLY_ADD": "a * b + c",
    "CROSS_PRODUCT": "cross(a, b)",
    "PROJECT": "vector_project(a, b)",
    "REFLECT": "vector_reflect(a, b)",
    "REFRACT": "vector_refract(a, b, scale)",
    "FACEFORWARD": "((dot(c, b) < 0.0) ? a : -a)",
    "SCALE": "a * scale",
    "NORMALIZE": "safe_normalize(a)",
    "ABSOLUTE": "abs(a)",
    "POWER": "vector_power(a, b)",
    "SIGN": "sign(a)",
    "MINIMUM": "min(a, b)",
    "MAXIMUM": "max(a, b)",
    "ROUND": "floor(a + 0.5)",
    "FLOOR": "floor(a)",
    "CEIL": "ceil(a)",
    "FRACTION": "fract(a)",
    "MODULO": "vector_modulo(a, b)",
    "WRAP": "vector_wrap(a, b, c)",
    "SNAP": "floor(safe_divide(a, b)) * b",
    "SINE": "sin(a)",
    "COSINE": "cos(a)",
    "TANGENT": "tan(a)",
}
VECTOR_NUMBERS = {
    "DOT_PRODUCT": "dot(a, b)",
    "DISTANCE": "distance(a, b)",
    "LENGTH": "length(a)",
}


def _expression(writer, kind, pattern, operands):
    """Write an operation with its operands as variables and return the result's variable."""
    names = {}
    for letter, (source, wanted) in operands.items():
        if letter in _names_in(pattern):
            names[letter] = writer.let(wanted, writer.value(source, wanted))
    words = "".join(names.get(word, word) for word in _words(pattern))
    return writer.let(kind, words)


def _words(pattern):
    word = ""
    for character in pattern:
        if character.isalnum() or character == "_":
            word += character
            continue
        yield word
        yield character
        word = ""
    yield word


def _names_in(pattern):
    return set(_words(pattern))


@generates("math", _MATH)
def _math(node, writer):
    operands = {letter: (node.input(letter), "float") for letter in "abc"}
    result = _expression(writer, "float", MATH[node.setting("operation")], operands)
    if node.setting("clamp"):
        result = writer.let("float", f"clamp({result}, 0.0, 1.0)")
    return {"Value": ("float", result)}


@generates("vector_math", _MATH)
def _vector_math(node, writer):
    operands = {letter: (node.input(letter), "vec3") for letter in "abc"}
    operands["scale"] = (node.input("scale"), "float")
    operation = node.setting("operation")
    # Only one of the outputs has a value.
    vector, number = "vec3(0.0)", "0.0"
    if operation in VECTOR_NUMBERS:
        number = _expression(writer, "float", VECTOR_NUMBERS[operation], operands)
    else:
        vector = _expression(writer, "vec3", VECTOR_MATH[operation], operands)
    return {"Vector": ("vec3", vector), "Value": ("float", number)}


@generates("clamp", _MATH)
def _clamp(node, writer):
    value, least, largest = (
        writer.value(node.input(name), "float") for name in ("Value", "Min", "Max")
    )
    if node.setting("type") == "RANGE":
        result = f"clamp_range({value}, {least}, {largest})"
    else:
        result = f"min(max({value}, {least}), {largest})"
    return {"Result": ("float", writer.let("float", result))}


@generates("map_range", _MATH)
def _map_range(node, writer):
    kind = "vec3" if node.setting("vector") else "float"

    def vector(name):
        value = writer.value(node.input(name), kind)
        return writer.let("vec3", value if kind == "vec3" else f"vec3({value})")

    value, from_min, from_max, to_min, to_max = map(
        vector, ("Value", "From Min", "From Max", "To Min", "To Max")
    )
    place = writer.let("vec3", f"map_place({value}, {from_min}, {from_max})")
    interpolation = node.setting("interpolation")
    if interpolation == "STEPPED":
        place = writer.let("vec3", f"map_steps({place}, {vector('Steps')})")
    elif interpolation == "SMOOTHSTEP":
        place = writer.let("vec3", f"map_smooth({place})")
    elif interpolation == "SMOOTHERSTEP":
        place = writer.let("vec3", f"map_smoother({place})")
    # A range without length maps everything to 0.
    mapped = f"{to_min} + {place} * ({to_max} - {to_min})"
    if kind == "float":
        mapped = f"(({from_max}.x != {from_min}.x) ? {mapped} : vec3(0.0))"
    result = writer.let("vec3", mapped)
    if node.setting("clamp"):
        result = writer.let("vec3", f"clamp_range({result}, {to_min}, {to_max})")
    if kind == "vec3":
        return {"Vector": ("vec3", result)}
    return {"Result": ("float", f"{result}.x")}


@generates("mix_value", _MATH)
def _mix_value(node, writer):
    kind = "vec3" if node.setting("vector") else "float"
    factor_kind = "vec3" if node.setting("by_component") else "float"
    factor = _factor(node, writer, factor_kind)
    a, b = (writer.value(node.input(name), kind) for name in "ab")
    result = writer.let(kind, f"mix({a}, {b}, {factor})")
    return {"Result": (kind, result)}


def _factor(node, writer, kind="float"):
    factor = writer.value(node.input("factor"), kind)
    return f"clamp({factor}, 0.0, 1.0)" if node.setting("clamp_factor") else factor


@generates("mix_color", _COLOR)
def _mix_color(node, writer):
    factor = _factor(node, writer)
    a, b = (writer.value(node.input(name), "vec3") for name in "ab")
    result = writer.let("vec3", f"blend_{node.setting('blend').lower()}({a}, {b}, {factor})")
    if node.setting("clamp_result"):
        result = writer.let("vec3", f"clamp({result}, 0.0, 1.0)")
    return {"Color": ("color", result)}


@generates("hue_saturation", _COLOR)
def _hue_saturation(node, writer):
    color = writer.value(node.input("Color"), "vec3")
    names = ("Hue", "Saturation", "Value", "Fac")
    values = ", ".join(writer.value(node.input(name), "float") for name in names)
    return {"Color": ("color", writer.let("vec3", f"color_hue_saturation({color}, {values})"))}


@generates("gamma", _COLOR)
def _gamma(node, writer):
    color = writer.value(node.input("Color"), "vec3")
    gamma = writer.value(node.input("Gamma"), "float")
    return {"Color": ("color", writer.let("vec3", f"color_gamma({color}, {gamma})"))}


@generates("contrast", _COLOR)
def _contrast(node, writer):
    color = writer.value(node.input("Color"), "vec3")
    values = ", ".join(writer.value(node.input(name), "float") for name in ("Bright", "Contrast"))
    return {"Color": ("color", writer.let("vec3", f"color_contrast({color}, {values})"))}


@generates("invert")
def _invert(node, writer):
    color = writer.let("vec3", writer.value(node.input("Color"), "vec3"))
    factor = writer.value(node.input("Fac"), "float")
    return {"Color": ("color", writer.let("vec3", f"mix({color}, 1.0 - {color}, {factor})"))}


@generates("luminance")
def _luminance(node, writer):
    # A colour becomes a value by its luminance.
    color = writer.value(node.input("Color"), "vec3")
    weights = ", ".join(map(str, writer.luminance))
    return {"Val": ("float", writer.let("float", f"dot({color}, vec3({weights}))"))}


_TO_RGB = {"RGB": "{}", "HSV": "hsv_to_rgb({})", "HSL": "hsl_to_rgb({})", "XYZ": "{}"}
_FROM_RGB = {"RGB": "{}", "HSV": "rgb_to_hsv({})", "HSL": "rgb_to_hsl({})", "XYZ": "{}"}


@generates("combine", _COLOR)
def _combine(node, writer):
    values = ", ".join(writer.value(node.input(name), "float") for name in "abc")
    model = node.setting("model")
    result = writer.let("vec3", _TO_RGB[model].format(f"vec3({values})"))
    return {"Result": ("vec3" if model == "XYZ" else "color", result)}


@generates("separate", _COLOR)
def _separate(node, writer):
    value = writer.value(node.input("Value"), "vec3")
    parts = writer.let("vec3", _FROM_RGB[node.setting("model")].format(value))
    return {name: ("float", f"{parts}.{axis}") for name, axis in zip("abc", "xyz", strict=True)}


@generates("ramp", "lib/finite_lib.glsl")
def _ramp(node, writer):
    place = f"clamp({writer.value(node.input('Fac'), 'float')}, 0.0, 1.0)"
    found = _look_up(writer, node.table, place, bool(node.setting("steps")))
    return {"Color": ("color", f"{found}.rgb"), "Alpha": ("float", f"{found}.a")}


@generates("curves", "lib/finite_lib.glsl")
def _curves(node, writer):
    kind = "float" if node.setting("channels") == "1" else "vec3"
    value = writer.let(kind, writer.value(node.input("Value"), kind))
    factor = writer.value(node.input("Fac"), "float")
    start, width = (writer.value(node.input(name), "float") for name in ("Start", "Width"))
    first = writer.table(node.table)
    components = []
    for axis in "x" if kind == "float" else "xyz":
        source = value if kind == "float" else f"{value}.{axis}"
        place = f"({source} - {start}) / {width}"
        if not node.setting("extrapolated"):
            place = f"clamp({place}, 0.0, 1.0)"
        components.append(f"{_interpolated(writer, first, len(node.table), place)}.{axis}")
    curved = components[0] if kind == "float" else f"vec3({', '.join(components)})"
    result = writer.let(kind, f"mix({value}, {curved}, {factor})")
    # A curve of a vector or a number is no colour.
    return {"Result": ("color" if node.setting("channels") == "RGB" else kind, result)}


def _look_up(writer, table, place, in_steps):
    first, count = writer.table(table), len(table)
    if not in_steps:
        return _interpolated(writer, first, count, place)
    index = f"{first} + int({place} * {float(count - 1)})"
    return writer.let("vec4", f"material_buf.constants[{index}]")


def _interpolated(writer, first, count, place):
    """Write the interpolated value of a table at a place, 0 to 1; extrapolated linearly beyond."""
    at = writer.let("float", f"number_or_zero({place}) * {float(count - 1)}")
    index = writer.let("int", f"int(clamp(floor({at}), 0.0, {float(count - 2)}))")
    ends = [f"material_buf.constants[{first + i} + {index}]" for i in range(2)]
    return writer.let("vec4", f"mix({ends[0]}, {ends[1]}, {at} - float({index}))")


@generates("black_body", "lib/finite_lib.glsl")
def _black_body(node, writer):
    temperature, coldest, hottest = (
        writer.value(node.input(name), "float") for name in ("Temperature", "Coldest", "Hottest")
    )
    clamped = f"clamp({temperature}, {coldest}, {hottest})"
    place = f"(1.0 / {clamped} - 1.0 / {hottest}) / (1.0 / {coldest} - 1.0 / {hottest})"
    return {"Color": ("color", f"{_look_up(writer, node.table, place, False)}.rgb")}


@generates("wavelength", "lib/finite_lib.glsl")
def _wavelength(node, writer):
    wavelength = writer.let("float", writer.value(node.input("Wavelength"), "float"))
    place = f"clamp(({wavelength} - 380.0) / 400.0, 0.0, 1.0)"
    found = _look_up(writer, node.table, place, False)
    seen = f"(({wavelength} < 380.0 || {wavelength} > 780.0) ? vec3(0.0) : {found}.rgb)"
    return {"Color": ("color", writer.let("vec3", seen))}


@generates("light_falloff", _MATH)
def _light_falloff(node, writer):
    strength, smooth, length = (
        writer.value(node.input(name), "float") for name in ("Strength", "Smooth", "Length")
    )
    far = writer.let("float", length)
    softened = f"({smooth} > 0.0 ? {far} * {far} / ({smooth} + {far} * {far}) : 1.0)"
    falling = writer.let("float", f"{strength} * {softened}")
    return {
        "Quadratic": ("float", falling),
        "Linear": ("float", f"({falling} * {far})"),
        "Constant": ("float", f"({falling} * {far} * {far})"),
    }


@generates("conductor")
def _conductor(node, writer):
    n, k = (writer.let("vec3", writer.value(node.input(i), "vec3")) for i in ("IOR", "Extinction"))
    reflected = f"(({n} - 1.0) * ({n} - 1.0) + {k} * {k})"
    whole = f"(({n} + 1.0) * ({n} + 1.0) + {k} * {k})"
    return {"Color": ("vec3", writer.let("vec3", f"{reflected} / max({whole}, vec3(1e-6))"))}
