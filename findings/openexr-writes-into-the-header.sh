#!/usr/bin/env bash
# OpenEXR's Python writer changes the header that it is given.
#
# `OpenEXR.File(header, channels)` takes a dictionary. One would expect it to be read, so that one
# header can serve several sizes.
# Seen (OpenEXR 3.5.3): dataWindow and displayWindow of the first picture are written into the
# caller's dictionary, where the next picture written with it finds them.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q OpenEXR==3.5.3 numpy==2.5.5
cat >look.py <<'PY'
import numpy as np
import OpenEXR
header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
with OpenEXR.File(header, {"Y": np.zeros((4, 6), np.float32)}) as file:
    file.write("large.exr")
print(sorted(header))
assert "dataWindow" in header and "displayWindow" in header, header
low, high = header["dataWindow"]
assert (list(low), list(high)) == ([0, 0], [5, 3]), header
PY
venv/bin/python look.py
echo "as described"
