"""Every pass compiles in every variant, and takes all that it declares and nothing else.

What was left out by the compiler (which that is differs between drivers) is passed over; a name
that was never declared fails everywhere.
"""

import ast
from pathlib import Path

import numpy as np
import pytest

import addon
from addon.device import shader_variants, shaders
from addon.device.shaders import ShaderInfo, compile_shader, dispatch
from addon.device.uniforms import uniform_buffer
from addon.errors import ShaderResourceError
from addon.passes import cryptomatte
from tests.every_shader import every_info, give, make_texture, resources_of, try_every_shader

pytestmark = pytest.mark.usefixtures("gpu_context")


def test_every_shader_takes_everything_that_it_declares():
    tried, failures = try_every_shader()
    assert failures == []
    # The enumeration does not run dry unnoticed.
    assert tried > 150


def test_a_shader_that_misses_anything_that_it_reads_refuses_to_draw():
    info = next(info for info in every_info() if info.name == "aplanat_splat")
    shader = compile_shader(info)
    names, texture_of = resources_of(info)
    for missing in names:
        shader.bind()
        for kind, name in names:
            if name != missing[1]:
                give(shader, kind, name, texture_of)
        with pytest.raises(ShaderResourceError, match=missing[1]):
            shader.check_given()


@pytest.mark.parametrize("kind", ["block", "sampler", "image", "int", "float"])
def test_a_name_that_was_never_declared_fails(kind):
    texture = make_texture("FLOAT_2D", "RGBA32F")
    for info in list(every_info())[::10]:
        shader = compile_shader(info)
        shader.bind()
        calls = {
            "block": (shader.uniform_block, uniform_buffer(bytes(16))),
            "sampler": (shader.uniform_sampler, texture),
            "image": (shader.image, texture),
            "int": (shader.uniform_int, 1),
            "float": (shader.uniform_float, 1.0),
        }
        give_it, value = calls[kind]
        with pytest.raises(ShaderResourceError, match="mispelled"):
            give_it("mispelled", value)


def test_what_the_compiler_leaves_out_is_passed_over_and_the_rest_is_set():
    info = ShaderInfo(
        name="leaves_out",
        compute=(
            "void main()\n{\n  imageStore(out_img, ivec2(0),"
            " vec4(float(used), read_buf.a.x, 0.0, 1.0));\n}\n"
        ),
        typedefs="struct Block { vec4 a; };\n",
        images=(("RGBA32F", "FLOAT_2D", "out_img", ("WRITE",)),),
        samplers=(("FLOAT_2D", "unread_tx"),),
        uniforms=(("Block", "read_buf"), ("Block", "unread_buf")),
        push_constants=(("INT", "used"), ("INT", "unread"), ("VEC4", "unread_vector")),
        local_size=(1, 1, 1),
    )
    shader = compile_shader(info)
    texture = make_texture("FLOAT_2D", "RGBA32F")
    read, unread = (uniform_buffer(np.float32((x, 0, 0, 0)).tobytes()) for x in (5, 6))
    shader.bind()
    shader.uniform_int("used", 7)
    shader.uniform_int("unread", 1)
    shader.uniform_float("unread_vector", (1.0, 2.0, 3.0, 4.0))
    shader.uniform_block("read_buf", read)
    shader.uniform_block("unread_buf", unread)
    shader.uniform_sampler("unread_tx", texture)
    shader.image("out_img", texture)
    dispatch(shader, 1, 1)
    np.testing.assert_array_equal(np.asarray(texture.read())[0, 0], (7.0, 5.0, 0.0, 1.0))


# Functions that make infos of module constants, and of surfaces' and worlds' nodes.
_ENUMERATED_ELSEWHERE = {
    "addon.passes.bokeh.clusters._info",
    "addon.passes.surface.environment_bake._info",
    "addon.passes.surface.surface_shader.surface_info",
}


def test_every_function_that_makes_a_shader_names_its_variants():
    root = Path(addon.__file__).parent
    makers = set()
    for path in root.rglob("*.py"):
        module = ".".join(("addon", *path.relative_to(root).with_suffix("").parts))
        for function in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(function, ast.FunctionDef) and any(
                isinstance(node, ast.Call) and getattr(node.func, "id", "") == "ShaderInfo"
                for node in ast.walk(function)
            ):
                makers.add(f"{module}.{function.name}")
    assert makers == shader_variants.marked() | _ENUMERATED_ELSEWHERE


def test_every_number_of_cryptomatte_levels_that_blender_offers_has_its_variant(aplanat_bpy):
    levels = aplanat_bpy.types.ViewLayer.bl_rna.properties["pass_cryptomatte_depth"]
    assert levels.hard_max == cryptomatte.MOST_LEVELS


def test_what_a_frame_compiles_is_among_the_variants():
    """Of all that this run has compiled so far, nothing of a pass is unknown to the enumeration."""
    known = every_info()
    # Those of surfaces and worlds are written for each tree of nodes.
    of_trees = {"surface", "places", "shading", "environment_bake"}
    names = {info.name for info in known} - {f"aplanat_{name}" for name in of_trees}
    unknown = [info for info in shaders._cache if info.name in names and info not in known]
    assert [(info.name, info.defines) for info in unknown] == []


# Blender counts a number as 8 bytes, two as 16, three and four as 16, and warns beyond 128.
_PUSHED = {"FLOAT": 8, "INT": 8, "BOOL": 8, "MAT4": 64}


def test_push_constants_are_no_more_than_every_device_has_room_for():
    sizes = {
        f"{info.name} {dict(info.defines)}": sum(
            _PUSHED.get(kind, 16) * max(*length, 1)
            for kind, _, *length in ((*each, 0, 0) for each in info.push_constants)
        )
        for info in every_info()
    }
    assert {name: size for name, size in sizes.items() if size > 128} == {}
