"""The formats of lens files that `fuzz_lens_files` mutates: readers, samples, lines to put in."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from addon.errors import LensFileError
from addon.lens_io.toml.toml_reader import parse_lens

REPOSITORY = Path(__file__).resolve().parents[2]


def _toml_document(content):
    return parse_lens(content, "mutated.toml").prescription


def _foreign(name):
    def read(content):
        from addon.lens_io.importers import ImportOptions, import_bytes

        try:
            return import_bytes(content, name).prescription
        except LensFileError as error:
            if "I06" not in {finding.code for finding in error.findings}:
                raise
        # What the file leaves open is answered, so that the mutation is read to its end.
        answers = ImportOptions("after", 3, "radius", f_number=4.0, half_field_deg=10.0)
        return import_bytes(content, name, answers).prescription

    return read


@dataclass(frozen=True)
class Format:
    """A kind of lens file.

    Parameters
    ----------
    read : callable
        bytes to Prescription; raises AplanatError.
    samples : sequence of str
        Patterns of sample files below the shared lenses and the shipped ones.
    lines : sequence of str
        Lines of the format that a mutation puts somewhere.
    """

    read: Callable
    samples: tuple[str, ...]
    lines: tuple[str, ...] = ()


FORMATS = {
    "toml": Format(
        _toml_document,
        ("*.toml",),
        (
            "[[surface]]",
            "[[zoom]]",
            "[lens]",
            "[focus]",
            'first = "D8"',
            "[diaphragm]",
            "stop = true",
            "conic = -1.0",
            'curved_along = "x"',
            "asphere = { a4_per_mm3 = 1e-5, a20_per_mm19 = 1e300 }",
            "asphere = { a2_per_mm1 = -5e-3, a3_per_mm2 = 1 }",
            "material = { nd = 1.5 }",
            "material = { nd = 1.5, vd = 60, dpgf = 1e300 }",
            "material = { sellmeier_b = [1.0, 0.2], sellmeier_c_um2 = [0.01, 0.3] }",
            "material = { series_um = [2.3, -0.01, 0.01, 1e-4, -1e-5, 1e-6] }",
            "thickness_mm = { D8 = 1e300, BF = 0.0 }",
            "x = " + "[" * 60 + "]" * 60,
            "x = " + "{a=" * 2000 + "1",
            "a." * 3000 + "b = 1",
            '"""',
            "'''",
            "\ufeff",
        ),
    ),
    "pbrt": Format(
        _foreign("mutated.dat"),
        ("*.dat",),
        (
            "0 0 0 0",
            "0 1.0 0 17.1",
            "-14.5 1.2 1.603 17.0",
            "# focal length 50",
            "0 1 1 12",
            "1e300 1e300 1.5 1e300",
            "1 2 3",
            "1 2 3 4 5",
        ),
    ),
    "zemax": Format(
        _foreign("mutated.zmx"),
        ("*.zmx",),
        (
            "SURF 3",
            "  TYPE EVENASPH",
            "  TYPE COORDBRK",
            "  TYPE TOROIDAL",
            "  CURV 1e-2 0 0 0 0",
            "  DISZ INFINITY",
            "  STOP",
            "  GLAS N-BK7 0 0 1.5 40.0",
            "  GLAS ___BLANK 1 0 1.6 40.0",
            "  GLAS MIRROR 0 0 1.5 40.0",
            "  PARM 2 1e300",
            "  DIAM 1e308 1 0 0 1",
            "  CLAP 0 4.0",
            "UNIT IN X W X CM MR CPMM",
            "MODE NSC",
            "MNUM 3 1",
            "MNUM 999999999 1",
            "THIC 4 2 1.0 0 0 1",
            "THIC 0 2 1000",
            "YFIE 2 2 12.0",
            "APER 0 2 4.0",
            "FLOA",
            "OBNA 0.1",
            "FTYP 3 0 3",
            "YFLN 0 1e308 -1",
            "GCAT HOYA",
            "  DISZ 400.0",
        ),
    ),
    "codev": Format(
        _foreign("mutated.seq"),
        ("*.seq",),
        (
            "RDM",
            "RDM N",
            "DIM I",
            "S 0.02 3.0 NBK7_SCHOTT",
            "S 1e300 1 517.642",
            "  STO",
            "  ASP; K -1; A 1e300",
            "  CIR 4",
            "XDE 1",
            "REFL",
            "ZOO 3",
            "S &",
            "SI 0 0",
            "S1 20 3 517642",
            "S 20 3 1.6:",
            "S 20 3 TAF3_HOYA",
            "TITLE 'not closed",
            "''",
            "PRV; PWL 587.6; 'X' 1.5; END",
            "NAO 0.1",
            "YRI 0 5 1e6",
            "; ;" * 500,
            "& \n" * 500,
            "'\"" * 500,
        ),
    ),
    "optical-bench": Format(
        _foreign("mutated.txt"),
        ("optical-bench/*.txt", "*.bench.txt"),
        (
            "[lens data]",
            "[aspherical data]",
            "[variable distances]",
            "AS\t3.2\t\t12.0",
            "4\tAS\t3.2\t\t12.0\t",
            "5\t29.5\t3.8\t1.67\t25\t47.1",
            "Focal Length\t50.0",
            "d5\t1.0\t2.0",
            "d8\t" + "1\t" * 60,
            "d0\tInfinity\t400\t300",
            "AsphericalOddCount\t1",
            "AsphericalA2",
            "4\tFS\t3.2\t\t12.0",
        ),
    ),
}


def samples(name, folders):
    """Return the sample files of a format, sorted by name."""
    patterns = FORMATS[name].samples
    found = {path for folder in folders for pattern in patterns for path in folder.rglob(pattern)}
    return [path.read_bytes() for path in sorted(found)]


def sample_folders():
    """Return the folders with lens files: shipped, of the tests, and those beside the checkout."""
    shared = REPOSITORY.parent / "shared" / "lenses"
    return [shared, REPOSITORY / "lens_profiles", REPOSITORY / "tests" / "lens_io"]
