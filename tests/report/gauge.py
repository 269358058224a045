"""A machine that reports what it is given: with it a picture's run can be made at will."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

from safeloc.language.expr import Expr, Var, boolean, choice, enumeration, members, number, optional
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, current_mode, modes
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT, MM
from safeloc.railway.pictures import Deviation, Things
from safeloc.report.recorded_run import Broken, RecordedRun
from safeloc.reported import Reported

MODEL = members("gauge_model", "NONE", "A", "B")
SILENT, TELLING = modes("SILENT", "TELLING")
FAR = 10_000_000
TOLERANCE_MM = 30_000


@cache
def system() -> TransitionSystem:
    """Reports the position and its margins below and above as they were given, while `told` is true."""
    told = boolean("told")
    given = {name: number(f"given_{name}", MM, -FAR, FAR) for name in ("position", "margin_below", "margin_above")}
    kept = {name: number(f"kept_{name}", MM, -FAR, FAR) for name in given}
    keep: dict[Var, Expr | Value] = {kept[name]: given[name] for name in given}
    beside = [optional("balise", COUNT, 1, 999), optional("balise_at", MM, 0, FAR), optional("next_at", MM, 0, FAR)]
    zone = [choice("next_model", enumeration(MODEL)), number("zone_from", MM, 0, FAR), number("zone_to", MM, 0, FAR)]
    both = (SILENT, TELLING)
    current = current_mode(both)
    machine = Machine(
        "gauge",
        modes=both,
        inputs=[told, *given.values(), *beside, *zone],
        state=dict.fromkeys(kept.values(), 0),
        outputs={"valid": current.eq(TELLING), **{f"{name}_mm": kept[name] for name in kept}},
        transitions=[
            Transition("tell", both, TELLING, told, keep, rank=0),
            Transition("be silent", both, SILENT, set=keep, rank=1),
        ],
    )
    return lower(machine)


PICTURE = Deviation(
    "Deviation",
    Reported(),
    TOLERANCE_MM,
    (
        Things("balise", "balise_at", "balise"),
        Things("reflector", "next_at", "next_model", ("zone_from", "zone_to"), {"drive": {40_000: "R<1>"}}),
    ),
)
QUIET: Mapping[str, Value | str] = {
    "told": True, "given_position": 0, "given_margin_below": 1_000, "given_margin_above": 2_000,
    "next_model": "NONE", "zone_from": 0, "zone_to": 0,
}  # fmt: skip


def drive(
    steps: Sequence[Mapping[str, Value | str]], truth_mm: Sequence[int | None], broken: Sequence[Broken] = ()
) -> RecordedRun:
    """A run with the given truth; each step says only what differs from QUIET."""
    trace = run(system(), [{**QUIET, **step} for step in steps])
    return RecordedRun("drive", trace, tuple(truth_mm), tuple(broken))
