"""JSON as the command line prints and writes it."""

import json

from ...files.whole_file import whole_file


def json_text(value, indent=None):
    """Return a value as JSON; numbers that are not finite become null."""
    text = json.dumps(_finite(value), indent=indent, ensure_ascii=False, allow_nan=False)
    # Names of files may hold bytes that are no text: half surrogates, which JSON writes as \udcff.
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def write_json(path, value):
    """Write a value to a JSON file, whole or not at all."""
    with whole_file(path) as place, open(place, "w", encoding="utf-8") as file:
        file.write(json_text(value, indent=2) + "\n")


def _finite(value):
    if isinstance(value, dict):
        return {str(key): _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not (abs(value) < float("inf")):
        return None
    return value
