"""A shader that is refused names the file and line of each error."""

import pytest

from addon.device import compiler_log, shader_source
from addon.device.shaders import ShaderInfo, compile_shader
from addon.errors import ShaderCompileError


def test_messages_are_located_in_their_stages_files():
    text = shader_source.join(
        ("lib/hash_lib.glsl", shader_source.Text("int a;\nint b;"), "passes/resolve_frag.glsl")
    )
    lines = text.splitlines()
    own = lines.index("int b;") + 1
    last = len(lines)
    console = (
        "gpu.shader | ERROR pyGPU_Shader FragShader:\n"
        f"  | python_shader.glsl:{own}:4: Error: no\n  | python_shader.glsl:{last}:1: Error: end\n"
    )
    messages = compiler_log.locate_messages(console, {"Frag": text})
    file_lines = (shader_source.SHADER_ROOT / "passes/resolve_frag.glsl").read_text().splitlines()
    assert messages == (
        f"generated:2: Error: no; passes/resolve_frag.glsl:{len(file_lines)}: Error: end"
    )


def test_an_error_names_file_and_line(aplanat_bpy):
    from addon.device import context

    context.ensure_context()
    fragment = shader_source.join(
        ("lib/hash_lib.glsl", shader_source.Text("void main()\n{\n  out_color = vec4(missing);\n}"))
    )
    info = ShaderInfo(
        name="broken on purpose",
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=fragment,
        attributes=(("VEC2", "pos"),),
        outputs=(("VEC4", "out_color"),),
    )
    with pytest.raises(ShaderCompileError, match=r"'broken on purpose'.*generated:3: .*missing"):
        compile_shader(info)
