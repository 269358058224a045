"""A choice between two groups of terms, field by field."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from safeloc.errors import ModelError
from safeloc.language.expr import Bool, Num, boolean, ite, number
from safeloc.language.terms import alike
from safeloc.language.units import MM
from safeloc.models.vocabulary.choose import choose


@dataclass(frozen=True, eq=False)
class Place:
    """A place, where there is one."""

    there: Bool
    where: Num


@dataclass(frozen=True, eq=False)
class Named:
    """A group with a field that is no term."""

    where: Num
    name: str


CONDITION = boolean("condition")
HERE, THERE = (Place(boolean(f"{name}_there"), number(f"{name}_mm", MM, 0, 9)) for name in ("here", "there"))


def test_every_field_is_chosen() -> None:
    """Numbers and truth values are chosen alike."""
    chosen = choose(CONDITION, HERE, THERE)
    assert alike(ite(CONDITION, HERE.there, THERE.there), chosen.there)
    assert alike(ite(CONDITION, HERE.where, THERE.where), chosen.where)


def test_a_field_that_is_no_term_is_refused() -> None:
    """A text is chosen by no condition."""
    message = (
        "^choose\\(\\) takes dataclasses of terms, and field name of Named is none; leave the field out, or write the choice "
        "by hand\\.$"
    )
    with pytest.raises(ModelError, match=message):
        choose(CONDITION, Named(HERE.where, "here"), Named(THERE.where, "there"))
