"""Every shader in every variant on Vulkan, in the real Blender; on OpenGL tests/gpu tries them."""

from pathlib import Path

import pytest

REPO = Path(__file__).resolve().parents[2]

CODE = """
import sys

sys.path.insert(0, {repo!r})
import gpu

gpu.init()
assert gpu.platform.backend_type_get() == {backend!r}
from tests.every_shader import try_every_shader

tried, failures = try_every_shader()
assert not failures, failures[:5]
assert tried > 150, tried
"""


@pytest.mark.slow
def test_every_variant_compiles_and_takes_all_that_it_declares(blender):
    backend = "vulkan"
    code = CODE.format(repo=str(REPO), backend=backend.upper())
    # Vulkan compiles three hundred pipelines in software.
    blender.run_code(code, options=("--gpu-backend", backend), timeout=900)
