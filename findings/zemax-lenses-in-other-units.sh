#!/usr/bin/env bash
# Zemax files in centimetres or inches: two open readers take the numbers and not the unit.
#
# `UNIT IN` in a .zmx file says that its lengths are inches. One would expect one singlet, written in
# millimetres, centimetres and inches, to be one lens to a program that reads it.
# Seen: optiland 0.6.3 drops the unit; its wavelengths stay micrometres and its lengths count as
# millimetres, so that the singlet in inches is 25.4 times smaller, and its wavefront error 0.047 waves
# instead of 1.19. rayoptics 0.9.8 keeps the unit by a name that its own conversion does not know ('CM',
# 'inches'; it knows 'cm' and 'in'), and then takes nanometres for units of the lens: -1.5 waves in
# millimetres are -1.5e-7 in centimetres and -6e-8 in inches. Focal lengths look right, in a unit that
# is not said. A CODE V sequence with `DIM I` goes the same way, `DIM C` comes out right.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python=${PYTHON:-python3.13}
"$python" -m venv ray && ray/bin/pip install -q rayoptics==0.9.8 opticalglass==1.1.1
"$python" -m venv land && land/bin/pip install -q optiland==0.6.3 numba==0.68.1 numpy==2.5.5

cat >write.py <<'PY'
# A biconvex singlet of f = 49.21 mm and f/6.2, the same in each file.
ZEMAX = """VERS 140124 258 36214
MODE SEQ
NAME singlet
UNIT {unit} X W X CM MR CPMM
ENPD {pupil:.10g}
GCAT SCHOTT
FTYP 0 0 1 1 0 0 0
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
  CURV {curvature:.10g}
  DISZ {thickness:.10g}
  GLAS N-BK7 0 0 1.5168 64.17
SURF 2
  TYPE STANDARD
  CURV -{curvature:.10g}
  DISZ {back:.10g}
SURF 3
  TYPE STANDARD
  CURV 0
  DISZ 0
"""
CODE_V = """RDM Y
DIM {unit}
EPD {pupil:.10g}
WL 587.6
REF 1
YAN 0
SO 0 1e10
S {radius:.10g} {thickness:.10g} NBK7_SCHOTT
 STO
S -{radius:.10g} {back:.10g}
SI 0 0
"""
for unit, letter, length in (("MM", "M", 1.0), ("CM", "C", 10.0), ("IN", "I", 25.4)):
    values = {
        "pupil": 8.0 / length,
        "curvature": 0.02 * length,
        "radius": 50.0 / length,
        "thickness": 5.0 / length,
        "back": 47.0 / length,
    }
    with open(f"{unit}.zmx", "w") as file:
        file.write(ZEMAX.format(unit=unit, **values))
    with open(f"{unit}.seq", "w") as file:
        file.write(CODE_V.format(unit=letter, **values))
PY
"$python" write.py

cat >ray.py <<'PY'
import contextlib, io, warnings
warnings.filterwarnings("ignore")
import numpy as np
from rayoptics.environment import open_model
from rayoptics.raytr.analyses import RayGrid
worst, focal = {}, {}
for name in ("MM.zmx", "CM.zmx", "IN.zmx", "MM.seq", "CM.seq", "IN.seq"):
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        model = open_model(name)
    worst[name] = float(np.nanmin(RayGrid(model, f=0, wl=587.6, num_rays=11, foc=0).grid[2]))
    focal[name] = model["analysis_results"]["parax_data"].fod.efl
    unit = model.system_spec.dimensions
    print(f"rayoptics {name}: unit {unit!r}, focal length {focal[name]:.4f}, {worst[name]:.3g} waves")
for kind in ("zmx", "seq"):
    for unit, length in (("MM", 1.0), ("CM", 10.0), ("IN", 25.4)):
        assert abs(focal[f"{unit}.{kind}"] * length - 49.2131) < 1e-3, focal
for name in ("MM.zmx", "MM.seq", "CM.seq"):
    assert abs(worst[name] + 1.546) < 0.01, worst
# 1e-6 mm a nanometre is left out: 10 mm or 25.4 mm are taken for one.
assert abs(worst["CM.zmx"] / -1.546e-7 - 1.0) < 0.01, worst
for name in ("IN.zmx", "IN.seq"):
    assert abs(worst[name] / -6.088e-8 - 1.0) < 0.01, worst
PY
ray/bin/python ray.py

cat >land.py <<'PY'
import contextlib, io
import numpy as np
from optiland.fileio import load_zemax_file
from optiland.wavefront import OPD
for unit, length in (("MM", 1.0), ("CM", 10.0), ("IN", 25.4)):
    with contextlib.redirect_stdout(io.StringIO()):
        lens = load_zemax_file(f"{unit}.zmx")
    focal = float(np.squeeze(lens.paraxial.f2()))
    error = float(OPD(lens, (0, 0), 0.5876).rms())
    print(f"optiland {unit}.zmx: focal length {focal:.4f}, wavefront {error:.4f} waves")
    assert abs(focal * length - 49.2131) < 1e-3 and abs(error * length - 1.1865) < 0.005
PY
land/bin/python land.py
echo "as described"
