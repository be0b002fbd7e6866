"""Uniform blocks are packed by the rules of std140, and the device reads what was packed."""

import numpy as np
import pytest

from addon.device.uniform_block import UniformStruct
from addon.errors import ShaderCompileError

# Offsets worked out by hand from the OpenGL specification, section 7.6.2.2.
LAYOUTS = {
    "float a; float b; vec2 c; vec4 d;": ({"a": 0, "b": 4, "c": 8, "d": 16}, 32),
    "float a; vec2 b; float c;": ({"a": 0, "b": 8, "c": 16}, 32),
    "float a; vec4 b; int c;": ({"a": 0, "b": 16, "c": 32}, 48),
    "int a; mat4 b; uint c;": ({"a": 0, "b": 16, "c": 80}, 96),
    # Elements of arrays are padded to 16 bytes, whatever their type.
    "float a; float b[3]; float c;": ({"a": 0, "b": 16, "c": 64}, 80),
    "vec2 a; vec2 b[2]; vec2 c;": ({"a": 0, "b": 16, "c": 48}, 64),
    "ivec4 a[2]; uvec4 b;": ({"a": 0, "b": 32}, 48),
}


@pytest.fixture
def declare(tmp_path, monkeypatch):
    """Return a function that makes a `UniformStruct` from the text of its members."""
    from addon.device import shader_source

    monkeypatch.setattr(shader_source, "SHADER_ROOT", tmp_path)
    counter = iter(range(1000))

    def struct(members):
        name = f"block_{next(counter)}.glsl"
        (tmp_path / name).write_text(f"struct Block {{ {members} }};\n")
        return UniformStruct(name, "Block")

    shader_source.load.cache_clear()
    yield struct
    shader_source.load.cache_clear()


@pytest.mark.parametrize("members", LAYOUTS)
def test_offsets_and_size_follow_std140(declare, members):
    struct = declare(members)
    offsets, size = LAYOUTS[members]
    assert {name: member.offset for name, member in struct.members.items()} == offsets
    assert struct.size == size


def test_a_matrix_is_packed_by_columns(declare):
    matrix = np.arange(16.0).reshape(4, 4)
    packed = np.frombuffer(declare("mat4 m;").pack(m=matrix), np.float32)
    assert (packed.reshape(4, 4) == matrix.T).all()


def test_integers_keep_their_bits(declare):
    packed = declare("int a; uint b; vec2 c;").pack(a=-2, b=4_000_000_000, c=(0.5, 1.0))
    assert np.frombuffer(packed, np.int32)[0] == -2
    assert np.frombuffer(packed, np.uint32)[1] == 4_000_000_000
    assert np.frombuffer(packed, np.float32)[2:].tolist() == [0.5, 1.0]


def test_a_missing_or_unknown_member_is_refused(declare):
    struct = declare("float a; float b;")
    with pytest.raises(TypeError, match="b"):
        struct.pack(a=1.0)
    with pytest.raises(TypeError, match="c"):
        struct.pack(a=1.0, b=1.0, c=1.0)


def test_too_many_elements_are_refused(declare):
    with pytest.raises(TypeError, match="3 elements given, 2 declared"):
        declare("vec4 a[2];").pack(a=np.zeros((3, 4)))


def test_a_type_without_packer_is_named(declare):
    with pytest.raises(ShaderCompileError, match="vec3"):
        declare("vec3 a;")


def test_the_device_reads_what_was_packed(aplanat_bpy, declare):
    from addon.device import context, state
    from addon.device.geometry import fullscreen_batch
    from addon.device.readback import read_color
    from addon.device.shaders import ShaderInfo, compile_shader
    from addon.device.targets import Targets, TargetSpec
    from addon.device.uniforms import uniform_buffer

    context.ensure_context()
    struct = declare("float a; vec2 b; float c[3]; mat4 d; ivec4 e; uint f;")
    matrix = np.arange(16.0).reshape(4, 4) / 8.0
    packed = struct.pack(a=0.25, b=(1.5, -2.0), c=(3.0, 4.0, 5.0), d=matrix, e=(1, -2, 3, -4), f=7)
    reads = [
        "vec4(block_buf.a, block_buf.b, block_buf.c[0])",
        "vec4(block_buf.c[1], block_buf.c[2], float(block_buf.f), 0.0)",
        "vec4(block_buf.e)",
        *[f"block_buf.d[{column}]" for column in range(4)],
    ]
    choices = "".join(f"  if (x == {i}) out_color = {read};\n" for i, read in enumerate(reads))
    info = ShaderInfo(
        name="block_test",
        vertex="void main() { gl_Position = vec4(pos, 1.0, 1.0); }",
        fragment=f"void main()\n{{\n  int x = int(gl_FragCoord.x);\n{choices}}}\n",
        typedefs=struct.source,
        attributes=(("VEC2", "pos"),),
        outputs=(("VEC4", "out_color"),),
        uniforms=(("Block", "block_buf"),),
    )
    with Targets(len(reads), 1, [TargetSpec("image", "RGBA32F")]) as targets:
        framebuffer = targets.framebuffer("image")
        with framebuffer.bind():
            state.overwrite()
            shader = compile_shader(info)
            shader.bind()
            # A block that nobody holds is freed at once, bound or not.
            block = uniform_buffer(packed)
            shader.uniform_block("block_buf", block)
            shader.draw(fullscreen_batch())
        found = read_color(framebuffer, len(reads), 1)[0]
    assert found[0].tolist() == [0.25, 1.5, -2.0, 3.0]
    assert found[1].tolist() == [4.0, 5.0, 7.0, 0.0]
    assert found[2].tolist() == [1.0, -2.0, 3.0, -4.0]
    # GLSL indexes columns.
    assert (found[3:] == matrix.T.astype(np.float32)).all()
