"""Every law of a shipped world says what an assessor asks: a sentence, its source, whose it is, and how it is checked."""

from __future__ import annotations

import pytest

from safeloc.catalogue import ENTRIES
from tests.shipped import laws_of


@pytest.mark.parametrize("name", ENTRIES)
def test_every_law_has_sentence_source_owner_and_check(name: str) -> None:
    """Nobody else would know what to see to."""
    lacking = {one.id: one.lacks for one in laws_of(name) if one.lacks}
    assert lacking == {}


@pytest.mark.parametrize("name", ENTRIES)
def test_figures_of_laws_are_in_the_configuration(name: str) -> None:
    """A law that names a figure which is not there would be read as if it had a value."""
    lost = {
        f"{one.id} {figure.name}"
        for one in laws_of(name)
        for figure in one.figures
        if figure.source == "not found in the configuration"
    }
    assert lost == set()
