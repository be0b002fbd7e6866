"""One texel that is no number leaves a whole picture, and the image is named."""

import numpy as np
import pytest

from addon.engine import outcome


@pytest.mark.parametrize("kind", ["nan", "inf"])
@pytest.mark.parametrize("method", ["ADAPTIVE", "REFERENCE"])
def test_a_texel_that_is_not_finite_does_not_spread(
    kind, method, open_case, render_default, monkeypatch
):
    open_case(f"r7-{kind}-texel")
    told = []
    note = outcome.RenderOutcome.note

    def listening(heard, lines):
        told.extend(lines)
        note(heard, lines)

    monkeypatch.setattr(outcome.RenderOutcome, "note", listening)
    picture = render_default(64, method)["ViewLayer"]["Combined"]
    assert np.isfinite(picture).all()
    assert any("image 'f'" in line and "not finite" in line for line in told)
    # The card of 0.4 is there: only its one black texel of 256 is missing, blurred.
    card = picture[30:60, 56:78, 0]
    assert card.mean() == pytest.approx(0.4, rel=0.05)
