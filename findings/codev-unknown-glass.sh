#!/usr/bin/env bash
# CODE V sequences in rayoptics: a glass that is not found becomes an index of 1.5.
#
# CODE V writes catalogue glasses without their hyphen and with the maker (NBK7_SCHOTT), and other
# glasses as `1.5168:64.17` or `517.642`. Other programs write N-BK7_SCHOTT. One would expect a
# reader to find N-BK7 in all of these, or to say that it does not know the glass.
# Seen (rayoptics 0.9.8): NBK7_SCHOTT and 517.642 are found; N-BK7_SCHOTT, NBK7 and the index form
# 1.5168:64.17 are replaced by a constant index of 1.5 without an error, which lengthens this
# singlet's focal length by 3.3 %.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv ray
ray/bin/pip install -q rayoptics==0.9.8 opticalglass==1.1.1
cat >ray.py <<'PY'
import contextlib, io, warnings
warnings.filterwarnings("ignore")
from rayoptics.environment import open_model
TEXT = """RDM Y
EPD 8
WL 587.6
REF 1
YAN 0
SO 0 1e10
S 31.5 4.0 {glass}
 STO
S -40.25 47.0
SI 0 0
"""
efl = {}
for glass in ("NBK7_SCHOTT", "517.642", "N-BK7_SCHOTT", "NBK7", "1.5168:64.17"):
    with open("lens.seq", "w") as file:
        file.write(TEXT.format(glass=glass))
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        model = open_model("lens.seq")
    efl[glass] = model["analysis_results"]["parax_data"].fod.efl
    print(f"{glass:14} efl {efl[glass]:.4f}  {model['seq_model'].gaps[1].medium}")
for glass in ("NBK7_SCHOTT", "517.642"):
    assert abs(efl[glass] - 34.85) < 0.02, efl
for glass in ("N-BK7_SCHOTT", "NBK7", "1.5168:64.17"):
    assert abs(efl[glass] - 36.0107) < 1e-3, efl
PY
ray/bin/python ray.py
echo "as described"
