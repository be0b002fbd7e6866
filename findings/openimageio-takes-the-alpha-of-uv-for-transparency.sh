#!/usr/bin/env bash
# OpenImageIO: the A of a UV pass comes first, is called alpha, and is divided out.
#
# Blender writes the UV pass of a multilayer file as U, V and A, where A is 1 where there is a surface.
# A reader that takes channels by position would expect U and V to be the first two; a filter, that they are data.
# Seen (OpenImageIO 3.2.2.0): A, U, V in this order, with channel 0 as alpha, for every layer whose
# only letter of a colour is A; so is Z, of a file that holds it beside named layers, the first channel.
# Unpremultiplying (as colour conversions do by default) divides U and V by A at the edges of things.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q openimageio==3.2.2.0 OpenEXR==3.5.3 numpy==2.5.5
cat >look.py <<'PY'
import numpy as np
import OpenEXR
import OpenImageIO as oiio


def written(channels):
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    pixels = {name: np.full((2, 2), value, np.float32) for name, value in channels.items()}
    OpenEXR.File(header, pixels).write("pass.exr")
    return oiio.ImageBuf("pass.exr")


uv = written({"layer.UV.U": 0.25, "layer.UV.V": 0.5, "layer.UV.A": 0.5})
print(uv.spec().channelnames, "alpha:", uv.spec().alpha_channel, uv.getpixel(0, 0))
assert uv.spec().channelnames == ("layer.UV.A", "layer.UV.U", "layer.UV.V")
assert uv.spec().alpha_channel == 0
divided = oiio.ImageBufAlgo.unpremult(uv).getpixel(0, 0)
print("unpremultiplied:", divided)
assert np.allclose(divided, (0.5, 0.5, 1.0))
depth = written({"Z": 7.0, "N.X": 1.0, "N.Y": 2.0, "N.Z": 3.0})
print(depth.spec().channelnames)
assert depth.spec().channelnames[0] == "Z"
PY
venv/bin/python look.py
echo "as described"
