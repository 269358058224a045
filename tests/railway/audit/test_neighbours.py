"""Expectation windows of balises, and directions told by models (RFL-D4, RFL-D5)."""

from __future__ import annotations

from safeloc.railway.audit import audit
from safeloc.railway.audit.findings import Finding
from safeloc.railway.map.model import Line
from tests.railway.map.made import group, reflector, straight


def found(line: Line, rule: str) -> list[Finding]:
    """Findings of one rule."""
    return [finding for finding in audit(line).findings if finding.rule == rule]


def test_windows_of_linked_groups_must_not_meet() -> None:
    """Two groups 60 m apart: both windows reach 31.3 m from either; told once, though both directions are run."""
    line = straight(500_000, travel="both", balise_groups=(group(1, "e0", 200_000), group(2, "e0", 260_000)))
    (one,) = found(line, "balise windows")
    assert ("balise groups g1 and g2", 60_000, ">", 62_600) == (
        one.subject,
        one.figures and one.figures.actual,
        one.figures and one.figures.relation,
        one.figures and one.figures.required,
    )
    assert [] == found(
        straight(500_000, balise_groups=(group(1, "e0", 200_000), group(2, "e0", 262_601))), "balise windows"
    )


def test_unlinked_groups_have_no_window() -> None:
    """Only what linking announces is expected."""
    groups = (group(1, "e0", 200_000), group(2, "e0", 205_000, 208_000, linked=False))
    assert [] == found(straight(500_000, balise_groups=groups), "balise windows")


def between(first: str, second: str, *places: int) -> Line:
    """A balise group between two reflectors."""
    return straight(
        500_000,
        balise_groups=(group(1, "e0", *places),),
        reflectors=(reflector("a", "e0", 50_000, first), reflector("b", "e0", 260_000, second)),
    )


def test_models_tell_the_direction_at_a_single_balise() -> None:
    """Equal models before and after a balise without orientation tell no direction: advice."""
    (one,) = found(between("A", "A", 200_000), "direction from models")
    assert ("advice", "balise group g1 between reflector a (A) and reflector b (A)") == (one.severity, one.subject)
    assert [] == found(between("A", "B", 200_000), "direction from models")


def test_a_group_with_orientation_needs_no_models() -> None:
    """Two balises tell the direction themselves."""
    line = between("A", "A", 200_000, 203_000)
    assert "direction from models" not in audit(line).cases
