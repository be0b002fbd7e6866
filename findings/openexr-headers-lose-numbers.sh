#!/usr/bin/env bash
# OpenEXR's Python writer: some values of a header are dropped or changed, and others of the kind refused.
#
# Attributes beside the pixels (frames, seeds, hashes, sizes) are Python values in a dictionary. One would
# expect each to be written or refused, as a tuple of mixed numbers or None is.
# Seen (OpenEXR 3.5.3): a list of floats and one of words come back as they were; a list of integers is
# not in the file. An integer beyond 32 bits becomes its lower 32 bits: 2**40 is 0, a hash of 3 000 000 000
# is negative. numpy.float64 is written as float of 32 bits, while numpy.float32, which would fit, and
# numpy.int32 are refused. Nothing is said about any of the first.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q OpenEXR==3.5.3 numpy==2.5.5
cat >look.py <<'PY'
import numpy as np
import OpenEXR

REFUSED = "refused"


def back(value):
    """Write a value as an attribute, and return what the file has, None if nothing, or REFUSED."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, "mine": value}
    try:
        with OpenEXR.File(header, {"Y": np.zeros((4, 6), np.float32)}) as file:
            file.write("picture.exr")
    except RuntimeError:
        return REFUSED
    with OpenEXR.File("picture.exr") as file:
        return file.header().get("mine")


for value, wanted in (
    ([1.0, 2.0], [1.0, 2.0]),
    (["a", "b"], ["a", "b"]),
    ([1, 2], None),
    (2**31 - 1, 2**31 - 1),
    (3_000_000_000, 3_000_000_000 - 2**32),
    (2**40, 0),
    (2**40 + 5, 5),
    (0.1, float(np.float32(0.1))),
    (np.float64(0.1), float(np.float32(0.1))),
    (np.float32(0.1), REFUSED),
    (np.int32(4), REFUSED),
    ((1, 2.5), REFUSED),
    (None, REFUSED),
):
    found = back(value)
    print(f"{value!r}: {found!r}")
    assert found == wanted and type(found) is type(wanted), (value, found)
PY
venv/bin/python look.py
echo "as described"
