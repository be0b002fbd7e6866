"""Importers of foreign lens files: pbrt, Zemax, CODE V, optical-bench tables."""

from .import_lens import ENDINGS, ImportedLens, import_bytes, import_lens
from .options import ImportOptions, glass_option

__all__ = [
    "ENDINGS",
    "ImportOptions",
    "ImportedLens",
    "glass_option",
    "import_bytes",
    "import_lens",
]
