"""What is to be kept is named by its identity, and by its kind as well where two kinds share one."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.railway.design.figures import Costs
from safeloc.railway.design.options import kept, standing
from tests.railway.map.made import group, marker, reflector, straight

LINE = straight(
    900_000,
    markers=(marker(1, "e0", 100_000), marker(2, "e0", 300_000)),
    reflectors=(reflector("m1", "e0", 500_000),),
    balise_groups=(group(7, "e0", 600_000),),
)


def test_an_identity_of_one_element() -> None:
    """The identity alone is enough, and the kind may be said."""
    assert {("marker", "m2")} == kept(LINE, ["m2"]) == kept(LINE, ["markers=m2"]) == kept(LINE, ["m2", "markers=m2"])


def test_an_identity_of_two_elements() -> None:
    """Without the kind it is refused, with both ways to say it; with the kind only that one is kept."""
    with pytest.raises(
        InputError,
        match=r"straight: 'm1' is a reflector and a marker; say which: --keep reflectors=m1 or --keep markers=m1\.",
    ):
        kept(LINE, ["m1"])
    asked = [one for one in standing(LINE, Costs(), ["markers=m1"]) if one.kept_for == "as asked"]
    assert [("marker", "m1")] == [(one.kind, one.element.id) for one in asked]


def test_an_identity_of_none() -> None:
    """It is refused, also where another kind has it."""
    with pytest.raises(InputError, match=r"straight has no balise group, reflector or marker 'B99'\."):
        kept(LINE, ["B99"])
    with pytest.raises(InputError, match=r"straight has no markers with id 'B7'\."):
        kept(LINE, ["markers=B7"])
    with pytest.raises(InputError, match=r"no balise group, reflector or marker 'signals=m1'\."):
        kept(LINE, ["signals=m1"])
