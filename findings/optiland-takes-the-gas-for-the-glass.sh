#!/usr/bin/env bash
# Zemax files in optiland: SF6 is a gas, and naming the catalogue is what hides another glass.
#
# A GLAS line has the glass' name and its index. A reader would be expected to use the one to check the
# other, and to be surer of a glass whose catalogue the file names (GCAT) than of one without.
# Seen (optiland 0.6.3): the index is not looked at. In a file without GCAT, SF6 (1.805, one of the most
# used flints) is sulfur hexafluoride, n = 1.0007, with a warning that there are several, and the focal
# length 34 m instead of 32 mm. Names that the database lacks become the first that begins like them: SK1
# (1.610) becomes SK16 (1.620) and BK1 (1.510) BK10 (1.569), with a warning. With GCAT SCHOTT they become
# N-SK10 (1.623) and N-BK10 (1.498), and there is no warning at all. Whoever reads files with it compares
# each surface's index with the file's.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv land
land/bin/pip install -q optiland==0.6.3 numba==0.68.1 numpy==2.5.5
cat >land.py <<'PY'
import contextlib, io, warnings
from pathlib import Path
import numpy as np
from optiland.fileio import load_zemax_file
TEXT = """VERS 140124 258 36214
MODE SEQ
NAME singlet
UNIT MM X W X CM MR CPMM
ENPD 8
{catalogs}FTYP 0 0 1 1 0 0 0
XFLN 0
YFLN 0
WAVM 1 0.5876 1
PWAV 1
SURF 0
  TYPE STANDARD
  CURV 0
  DISZ INFINITY
SURF 1
  STOP
  TYPE STANDARD
  CURV 0.02
  DISZ 5
  GLAS {glass}
SURF 2
  TYPE STANDARD
  CURV -0.02
  DISZ 95
SURF 3
  TYPE STANDARD
  CURV 0
  DISZ 0
"""
for line, catalogs, name, index in (
    ("SF6 0 0 1.80518 25.43", "", "SF6/Vukovic.yml", 1.00073),
    ("SF6 0 0 1.80518 25.43", "GCAT SCHOTT\n", "schott/SF6.yml", 1.80518),
    ("SK1 0 0 1.61025 56.71", "", "hikari/SK16.yml", 1.62041),
    ("SK1 0 0 1.61025 56.71", "GCAT SCHOTT\n", "schott/N-SK10.yml", 1.62278),
    ("BK1 0 0 1.51009 63.44", "", "lzos/BK10.yml", 1.56889),
    ("BK1 0 0 1.51009 63.44", "GCAT SCHOTT\n", "schott/N-BK10.yml", 1.49782),
):
    with open("lens.zmx", "w") as file:
        file.write(TEXT.format(glass=line, catalogs=catalogs))
    told = io.StringIO()
    with warnings.catch_warnings(record=True) as warned, contextlib.redirect_stdout(told):
        warnings.simplefilter("always")
        lens = load_zemax_file("lens.zmx")
    material = lens.surfaces[1].material_post
    found = float(np.squeeze(material.n(0.5876)))
    focal = float(np.squeeze(lens.paraxial.f2()))
    source = "/".join(Path(material.filename).parts[-2:])
    words = "; ".join(str(w.message).split(";")[0] for w in warned) or "no warning"
    print(f"{line}, {catalogs.strip() or 'no catalogue'}: {source}, n {found:.5f}, f {focal:.2f}; {words}")
    assert source == name and abs(found - index) < 2e-5
    assert bool(warned) == (catalogs == "") and told.getvalue() == ""
PY
land/bin/python land.py
echo "as described"
