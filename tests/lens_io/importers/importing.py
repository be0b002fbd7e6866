"""Reading texts as files of a format, and what is refused of them."""

import pytest

from addon.errors import LensFileError
from addon.lens_io.importers import ImportOptions, import_bytes


def read(text, name, **options):
    return import_bytes(text.encode(), name, ImportOptions(**options))


def refusal(text, name, **options):
    with pytest.raises(LensFileError) as caught:
        read(text, name, **options)
    return caught.value.findings


def assert_refused(text, name, code, *said, **options):
    findings = refusal(text, name, **options)
    assert {finding.code for finding in findings} == {code}, findings
    for words in said:
        assert any(words in f"{one.path} {one.message}" for one in findings), findings


def edited(text, old, new):
    assert old in text
    return text.replace(old, new, 1)
