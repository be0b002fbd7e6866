"""Importers of foreign lens files: pbrt, Zemax, CODE V, optical-bench tables."""

from .draft.options import ImportOptions, glass_option
from .import_lens import ENDINGS, ImportedLens, import_bytes, import_lens

__all__ = [
    "ENDINGS",
    "ImportOptions",
    "ImportedLens",
    "glass_option",
    "import_bytes",
    "import_lens",
]
