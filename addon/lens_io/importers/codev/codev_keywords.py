"""The keywords of CODE V sequences, by what they do."""

import re

# Of the command DIM.
UNITS_MM = {"M": 1.0, "C": 10.0, "I": 25.4}
# Farther than this, in the file's unit, an object is at infinity: the program writes 1e10 or more.
FARTHEST = 1.0e9
APERTURES = {
    "EPD": "entrance pupil",
    "FNO": "working f-number",
    "NA": "image NA",
    "NAO": "object NA",
}
# Words for a distance without end, as other programs write them into sequences.
ENDLESS = {"INF", "INFINITY"}
# In a surface, a curvature or thickness may be solved for a ray or picked up; the program keeps the
# value that it found in the S line.
SOLVED = {"CUY", "RDY", "THI"}
_SOLVE_WORDS = "UMY UCY UMX UCX HMY HCY HMX HCX IMY ICY IPY APY ASY PIK CRP SYM"
SOLVES = set(_SOLVE_WORDS.split())
FIELDS = {
    "AN": "angle",
    "IM": "image height",
    "RI": "real image height",
    "OB": "object height",
}
# a4, a6 ... a20.
COEFFICIENTS = {letter: order for letter, order in zip("ABCDEFGHJ", range(4, 22, 2), strict=True)}
MIRRORS = {"REFL", "RFL", "TIR"}
OFF_AXIS = {"XDE", "YDE", "ZDE", "ADE", "BDE", "CDE", "DAR", "BEN", "REV", "RET", "ADX", "ADY"}
_SHAPE_WORDS = """
    AAS ARY CUX CYL DIF DOE FRE GRO GRS GRT HCT HOE KNS LMD MOD NSS ODD QBF QCN RDX SPL SPN SPS
    SPX THR TOR UDS XTO XZP YTO ZRN ELX ELY REX REY
"""
OTHER_SHAPES = set(_SHAPE_WORDS.split())
# A lens that is changed after it was written down.
EDITS = {"SCA", "FLY", "INS", "DEL", "COP", "RDY", "CUY", "THI", "GLA", "INV"}
# A label of an aperture, such as L'rim'.
LABEL = re.compile(r"[Ll]'[^']*'")
LENS_WORDS = {"LEN", "TITLE", "DIM", "RDM", "WL", "REF", "SO", "S", "SI", "GO"}
