#!/usr/bin/env bash
# Zemax files in rayoptics: a surface of a kind that it does not know becomes a sphere, without a word.
#
# An extended asphere of a phone's or camera's lens (XASPHERE), an odd one (ODDASPHE), a biconic or a
# gradient index: a reader would be expected to read it or to refuse the file.
# Seen (rayoptics 0.9.8): the file is read as if the terms were not there; of a surface that is 1.12 or
# 1.21 mm deep at 10 mm the 1.01 mm of its sphere are left. Nothing is raised, printed or warned of; the
# counts that `open_model(..., info=True)` gives hold the surface's kind like any other, and the log tells
# of lines it did not use (MODE, PWAV), but not of this one. Terms of an EVENASPH are read. optiland 0.6.3
# reads the odd asphere and refuses the others by name.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python=${PYTHON:-python3.13}
"$python" -m venv ray && ray/bin/pip install -q rayoptics==0.9.8 opticalglass==1.1.1
"$python" -m venv land && land/bin/pip install -q optiland==0.6.3 numba==0.68.1 numpy==2.5.5
cat >files.py <<'PY'
TEXT = """VERS 140124 258 36214
MODE SEQ
NAME singlet
UNIT MM X W X CM MR CPMM
ENPD 8
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
  TYPE {kind}
  CURV 0.02
  CONI 0
{terms}
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
SPHERE = 0.02 * 100.0 / (1.0 + (1.0 - 0.02**2 * 100.0) ** 0.5)
# Terms of a kind, and how deep it is at 10 mm.
KINDS = {
    "EVENASPH": ("  PARM 1 1e-3\n  PARM 2 1e-5", SPHERE + 1e-3 * 10.0**2 + 1e-5 * 10.0**4),
    "ODDASPHE": ("  PARM 1 0\n  PARM 2 1e-3\n  PARM 3 1e-4", SPHERE + 1e-3 * 10.0**2 + 1e-4 * 10.0**3),
    "XASPHERE": (
        "  XDAT 1 2 0 0\n  XDAT 2 10 0 0\n  XDAT 3 0.1 0 0\n  XDAT 4 0.01 0 0",
        SPHERE + 0.1 + 0.01,
    ),
    "BICONICX": ("  PARM 1 30", None),
    "GRINSUR1": ("  PARM 1 1\n  PARM 2 1.6\n  PARM 3 0.01", None),
}
for kind, (terms, _) in KINDS.items():
    with open(f"{kind}.zmx", "w") as file:
        file.write(TEXT.format(kind=kind, terms=terms))
PY
cat >ray.py <<'PY'
import contextlib, io, logging, warnings
from files import KINDS, SPHERE
with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from rayoptics.environment import open_model
for kind, (_, depth) in KINDS.items():
    told, log = io.StringIO(), io.StringIO()
    handler = logging.StreamHandler(log)
    logging.getLogger().addHandler(handler)
    with warnings.catch_warnings(record=True) as warned, contextlib.redirect_stdout(told):
        warnings.simplefilter("always")
        with contextlib.redirect_stderr(told):
            model, info = open_model(f"{kind}.zmx", info=True)
    logging.getLogger().removeHandler(handler)
    profile = model["seq_model"].ifcs[1].profile
    found = float(profile.sag(0.0, 10.0))
    about = [str(w.message) for w in warned if kind.lower() in str(w.message).lower()]
    print(f"rayoptics {kind}: {type(profile).__name__}, depth {found:.4f} mm, of {depth}")
    print("   ", told.getvalue().strip() or "nothing printed", "| log:", log.getvalue().split("\n"))
    assert abs(found - (depth if kind == "EVENASPH" else SPHERE)) < 1e-9
    assert info[0][kind] == 1
    assert not about and told.getvalue() == "" and kind not in log.getvalue()
PY
cat >land.py <<'PY'
import contextlib, io
import numpy as np
from optiland.fileio import load_zemax_file
from files import KINDS
for kind, (_, depth) in KINDS.items():
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            lens = load_zemax_file(f"{kind}.zmx")
    except ValueError as error:
        print(f"optiland {kind}: {error}")
        assert kind.lower() in str(error).lower()
        continue
    found = float(np.squeeze(lens.surfaces[1].geometry.sag(0.0, 10.0)))
    print(f"optiland {kind}: depth {found:.4f} mm, of {depth:.4f}")
    assert abs(found - depth) < 1e-9
PY
ray/bin/python ray.py
land/bin/python land.py
echo "as described"
