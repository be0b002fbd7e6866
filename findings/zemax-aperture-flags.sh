#!/usr/bin/env bash
# Zemax: the second number of OBNA and FNUM, and two open readers of .zmx files.
#
# In a sequential .zmx file `OBNA v 0` is a numerical aperture at the object and `OBNA v 1` a cone
# angle in degrees; `FNUM v 0` is the f-number of an object at infinity and `FNUM v 1` the working
# f-number of the object in the file. One would expect readers to keep them apart or to refuse.
# Seen: rayoptics 0.9.8 takes 6 degrees as a numerical aperture of 6 (f/0.08, no error), and both
# f-numbers as the working one; optiland 0.6.3 takes both as the one of infinity, and refuses the
# cone angle. For a near object the two programs therefore give pupils that differ by a factor 1.95,
# and each is wrong for one of the two files.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python=${PYTHON:-python3.13}
"$python" -m venv ray && ray/bin/pip install -q rayoptics==0.9.8 opticalglass==1.1.1
"$python" -m venv land && land/bin/pip install -q optiland==0.6.3 numba==0.68.1 numpy==2.5.5

cat >write.py <<'PY'
# A biconvex singlet, imaged about 1 : 1; its stop is the first surface.
TEXT = """VERS 140124 258 36214
MODE SEQ
NAME singlet
UNIT MM X W X CM MR CPMM
{aperture}
FTYP 1 0 2 1 0 0 0
XFLN 0 0
YFLN 0 5
WAVM 1 0.5876 1
PWAV 1
SURF 0
  TYPE STANDARD
  CURV 0
  DISZ 97.5
SURF 1
  STOP
  TYPE STANDARD
  CURV 0.02
  DISZ 5
  GLAS N-BK7 0 0 1.5168 64.17
  DIAM 11 0 0 0 1 ""
SURF 2
  TYPE STANDARD
  CURV -0.02
  DISZ 95
  DIAM 11 0 0 0 1 ""
SURF 3
  TYPE STANDARD
  CURV 0
  DISZ 0
"""
for name, aperture in (
    ("cone", "OBNA 6 1"),
    ("infinity", "FNUM 8 0"),
    ("working", "FNUM 8 1"),
):
    with open(f"{name}.zmx", "w") as file:
        file.write(TEXT.format(aperture=aperture))
PY
"$python" write.py

cat >ray.py <<'PY'
import contextlib, io, warnings
warnings.filterwarnings("ignore")
from rayoptics.environment import open_model
radius = {}
for name in ("cone", "infinity", "working"):
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        model = open_model(f"{name}.zmx")
    first_order = model["analysis_results"]["parax_data"].fod
    radius[name] = first_order.enp_radius
    print(f"rayoptics {name}: pupil radius {first_order.enp_radius:.4f}, f/{first_order.fno:.3f}")
# 6 degrees: 97.5 tan(6 degrees) = 10.25 mm. Numerical aperture 6, taken as a slope: 585 mm.
assert abs(radius["cone"] - 585.0) < 0.1, radius
assert abs(radius["infinity"] - radius["working"]) < 1e-9, radius
assert abs(radius["working"] - 6.0022) < 1e-3, radius
PY
ray/bin/python ray.py

cat >land.py <<'PY'
import contextlib, io
from optiland.fileio import load_zemax_file
diameter = {}
for name in ("cone", "infinity", "working"):
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            lens = load_zemax_file(f"{name}.zmx")
    except ValueError as error:
        print(f"optiland {name}: {error}")
        diameter[name] = None
        continue
    diameter[name] = float(lens.paraxial.EPD())
    print(f"optiland {name}: pupil diameter {diameter[name]:.4f}")
assert diameter["cone"] is None, diameter
# 49.213 mm / 8, whatever the second number says.
assert abs(diameter["infinity"] - 6.1516) < 1e-3, diameter
assert abs(diameter["working"] - 6.1516) < 1e-3, diameter
PY
land/bin/python land.py
echo "as described"
