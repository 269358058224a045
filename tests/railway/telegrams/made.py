"""Values of any packet that is known, and packets of which the values are published."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from hypothesis import strategies as st

from safeloc.railway.telegrams.layout import Given, Listed, Part
from safeloc.railway.telegrams.packets import BODIES, OTHER_DATA, Sender
from safeloc.railway.telegrams.variables import variable_of


@st.composite
def layouts(draw: st.DrawFn, parts: Sequence[Part], outer: dict[str, Any] | None = None) -> dict[str, Any]:
    """Values of a layout. outer: those of the layout around it."""
    values: dict[str, Any] = {}
    for part in parts:
        known = {**(outer or {}), **values}
        match part:
            case Given(name, accepted, inner):
                values |= draw(layouts(inner, known)) if known[name] in accepted else {}
            case Listed(name, inner):
                values[name] = draw(st.lists(layouts(inner, known), max_size=3))
            case str():
                variable = variable_of(part)
                values[part] = draw(
                    st.sampled_from(sorted(set(range(2**variable.bits)) - variable.spare))
                    if variable.spare
                    else st.integers(0, 2**variable.bits - 1)
                )
    return values


def packets(sender: Sender, *numbers: int) -> st.SearchStrategy[dict[str, Any]]:
    """A packet of this sender, without L_PACKET; one of these numbers, if any are given."""
    known = numbers or sorted(number for owner, number in BODIES if owner == sender)
    direction = {"Q_DIR": st.integers(0, 2)} if sender == "track" else {}

    def whole(number: int) -> st.SearchStrategy[dict[str, Any]]:
        head = st.fixed_dictionaries({"NID_PACKET": st.just(number), **direction})
        data = {"bits": st.text("01", max_size=60)} if number == OTHER_DATA else {}
        parts = (head, layouts(BODIES[sender, number]), st.fixed_dictionaries(data))
        return st.tuples(*parts).map(lambda each: each[0] | each[1] | each[2])

    return st.sampled_from(known).flatmap(whole)
