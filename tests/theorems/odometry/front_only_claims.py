"""Odometry with both readers is never worse than with the front reader alone, on one stream (MRK-1, MRK-D3)."""

from __future__ import annotations

from safeloc.language.expr import maximum
from safeloc.language.spec import Property, always
from safeloc.models.odometry.marker_reading import OUT_OF_ORDER, OUT_OF_WINDOW, REPEATED
from safeloc.properties.odometry import LAW
from tests.theorems.odometry.front_only import Comparison
from tests.theorems.odometry.line_ahead import LineAhead

GIVEN = (
    "neither machine turns about, refuses a reading of the front reader, or finds its devices excluding each other; while "
    "the front reader alone reports nothing, the front reader reads nothing that is worth less than what the front "
    "device of the other machine still has"
)
ON_A_LINE = (
    f"{LAW}; forward run; the front reader comes to each marker once, in order, and what it reads of known ones is true"
)
SOURCES = ("MRK-1", "MRK-D3", "MRK-D5")


def properties(whole: Comparison) -> list[Property]:
    """Valid wherever the other is, and with a margin that is not greater."""
    both, alone = whole.both.machine, whole.alone.machine
    valid, valid_alone = whole.of_both.bool(both.flag("valid")), whole.of_alone.bool(alone.flag("valid"))
    margin = whole.of_both.num(maximum(both.output("margin_above_mm"), both.output("margin_below_mm")))
    margin_alone = whole.of_alone.num(maximum(alone.output("margin_above_mm"), alone.output("margin_below_mm")))
    exact, exact_alone = whole.of_both.num(whole.both.lead.margin), whole.of_alone.num(whole.alone.lead.margin)
    return [
        always(
            "valid wherever the front reader alone is",
            valid_alone.implies(valid),
            statement="whenever the machine with the front reader alone reports a position, the one with both does",
            requirements=SOURCES,
            assumption=GIVEN,
        ),
        always(
            "no greater margin than the front reader alone",
            valid_alone.implies((margin <= margin_alone) & (exact <= exact_alone)),
            statement="whenever the machine with the front reader alone reports a position, the one with both reports a "
            "margin that is not greater, in nm as well as in the mm of its report",
            requirements=SOURCES,
            assumption=GIVEN,
        ),
    ]


def line_properties(whole: LineAhead) -> list[Property]:
    """Claim that the assumptions of the comparison hold on every line ahead."""
    source, says = whole.source, whole.says
    verdict = says.num(source.own.readers[0].verdict)
    return [
        always(
            "no true reading is refused",
            ~verdict.one_of(REPEATED, OUT_OF_ORDER, OUT_OF_WINDOW),
            statement="on a line ahead no reading at the front is refused as repeated, out of order or out of the window",
            requirements=SOURCES,
            assumption=ON_A_LINE,
        )
    ]
