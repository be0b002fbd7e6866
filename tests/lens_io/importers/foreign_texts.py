"""One lens, a biconvex singlet with the stop behind it, in each of the foreign formats."""

RADIUS, THICKNESS, GAP, LAST = 50.0, 4.0, 3.0, 45.0
ND, VD = 1.5168, 64.17

PBRT = f"""# Singlet
# for tests
{RADIUS} {THICKNESS} {ND} 20
-{RADIUS} {GAP} 1 20
0 0 0 12
"""

ZEMAX = f"""VERS 140730 73 26155
MODE SEQ
NAME Singlet
UNIT MM X W X CM MR CPMM
ENPD 10
GCAT SCHOTT
FTYP 0 0 2 1 0 0 0
YFLN 0 8
WAVM 1 0.5875618 1
PWAV 1
SURF 0
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ INFINITY
SURF 1
  TYPE STANDARD
  CURV {1 / RADIUS} 0 0 0 0 ""
  DISZ {THICKNESS}
  GLAS ___BLANK 1 0 {ND} {VD} 0 0 0 0 0 0
  DIAM 10 1 0 0 1 ""
SURF 2
  TYPE STANDARD
  CURV -{1 / RADIUS} 0 0 0 0 ""
  DISZ {GAP}
  DIAM 10 1 0 0 1 ""
SURF 3
  STOP
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ {LAST}
  DIAM 6 0 0 0 1 ""
SURF 4
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ 0
  DIAM 7 0 0 0 1 ""
"""

CODEV = f"""RDM; LEN "VERSION: 10.7"
TITLE 'Singlet'
EPD 10
DIM M
WL 656.3 587.6 486.1
REF 2
YAN 0.0 8.0
SO 0.0 1e10
S {RADIUS} {THICKNESS} {ND}:{VD}
  CIR 10
S -{RADIUS} {GAP}
  CIR 10
S 0.0 {LAST}
  STO
SI 0.0 0.0
GO
"""

BENCH = "\n".join(
    (
        "[descriptive data]",
        "title\tSinglet",
        "[constants]",
        "[variable distances]",
        "Focal Length\t49.1",
        "F-Number\t4.3",
        "Angle of View\t16",
        f"Bf\t{LAST}",
        "[lens data]",
        f"1\t{RADIUS}\t{THICKNESS}\t{ND}\t20\t{VD}",
        f"2\t-{RADIUS}\t{GAP}\t\t20",
        "2AS\tAS\tBf\t\t11",
        "",
    )
)
