"""Prefix sums of tables of whole numbers on the device.

A table is a list in rows of `COLUMNS` columns, as textures are not long enough for one row.
"""

from ...device import shader_source
from ...device.shader_variants import variants
from ...device.shaders import ShaderInfo, compile_shader, dispatch

COLUMNS = 1024

_THREADS = 256


@variants(totals=(False, True))
def _info(totals):
    images = [("R32UI", "UINT_2D", "totals_img", ("READ", "WRITE"))]
    images += [("R32UI", "UINT_2D", "keys_img", ("READ", "WRITE"))] * (not totals)
    return ShaderInfo(
        name="aplanat_prefix_sums",
        compute=shader_source.load("passes/visibility/prefix_sums_comp.glsl"),
        typedefs=f"shared uint sums[{_THREADS}];\n",
        images=tuple(images),
        push_constants=(("INT", "rows"),) * totals,
        defines=(
            ("SOURCE_COLUMNS", str(COLUMNS)),
            ("THREADS", str(_THREADS)),
            *[("TOTALS", "1")] * totals,
        ),
        local_size=(_THREADS, 1, 1),
    )


def add_up(numbers, totals):
    """Turn a table of numbers into prefix sums: within its rows, and of the rows.

    Parameters
    ----------
    numbers : GPUTexture
        R32UI, `COLUMNS` wide.
    totals : GPUTexture
        R32UI, `COLUMNS` wide: gets for each row the sum of all rows before it.
    """
    for over_rows in (False, True):
        shader = compile_shader(_info(over_rows))
        shader.bind()
        shader.image("totals_img", totals)
        if over_rows:
            shader.uniform_int("rows", numbers.height)
        else:
            shader.image("keys_img", numbers)
        dispatch(shader, 1 if over_rows else numbers.height, 1)
