"""A line knows its version and checksum, and refuses a checksum that is not its own."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from safeloc.railway.map.elements import Reflector, TrackEdge, opposite
from safeloc.railway.map.model import Line, content_checksum, sealed
from tests.railway.map.made import group, reflector, straight


def test_a_sealed_line_carries_its_checksum() -> None:
    """Sealing adds the checksum of the content and changes nothing else."""
    line = straight(1_000)
    assert content_checksum(line) == sealed(line).checksum
    assert line == sealed(line).model_copy(update={"checksum": None})


def test_the_checksum_is_canonical() -> None:
    """It depends on content alone: not on the checksum already there, nor on writing defaults out."""
    line = straight(1_000)
    assert content_checksum(line) == content_checksum(sealed(line))
    spelt_out = line.model_copy(update={"edges": (line.edges[0].model_copy(update={"track": ""}),)})
    assert content_checksum(line) == content_checksum(spelt_out)


def test_any_change_changes_the_checksum() -> None:
    """A millimetre, a name or a version more is another content."""
    line = straight(1_000)
    others = (straight(1_001), line.model_copy(update={"version": "2"}), line.model_copy(update={"name": "other"}))
    assert len({content_checksum(one) for one in (line, *others)}) == 4


def test_a_wrong_checksum_is_refused() -> None:
    """A line whose content was changed after sealing is not made."""
    line = sealed(straight(1_000))
    with pytest.raises(ValidationError, match=r"checksum is sha256:\w+, but the content has sha256:\w+: do not use it"):
        Line(**(dict(line) | {"version": "2"}))


def test_figures_must_be_whole_and_finite() -> None:
    """Fractions of a millimetre, negative lengths and unknown fields are no figures."""
    sound = reflector("r", "e0", 1).model_dump()
    for wrong in ({"position_mm": 0.5}, {"position_mm": -1}, {"view_from_mm": 0}, {"colour": "red"}, {"model": "4 A"}):
        with pytest.raises(ValidationError):
            Reflector(**(sound | wrong))
    with pytest.raises(ValidationError, match="finite"):
        TrackEdge.model_validate_json(
            '{"id":"e","from_node":"a","to_node":"b","length_mm":5,"geometry":{"points":[[0,0],[NaN,1]]}}'
        )


def test_orientation_follows_the_order_of_balises() -> None:
    """Two balises tell the nominal direction; a single one is told by linking, or is unknown."""
    assert "increasing" == group(1, "e0", 5, 9).orientation
    assert "decreasing" == group(1, "e0", 9, 5).orientation
    assert "decreasing" == group(1, "e0", 9, nominal_direction="decreasing").orientation
    assert group(1, "e0", 9).orientation is None


def test_a_group_stands_where_its_first_balise_is() -> None:
    """The origin of a group is balise number 1 (SUBSET-026 3.4.2.2.1)."""
    assert 9 == group(1, "e0", 9, 5).position_mm


def test_elements_are_frozen() -> None:
    """Declared once, then never changed."""
    made = reflector("r", "e0", 1)
    with pytest.raises(ValidationError, match="frozen"):
        made.position_mm = 5  # type: ignore[misc]
    assert isinstance(made, Reflector)
    assert ("decreasing", "increasing") == (opposite("increasing"), opposite("decreasing"))
