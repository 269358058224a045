"""Two machines in one composition: one states an interval on the line, one watches it and has an input that no recording has."""

from __future__ import annotations

from safeloc.language.composition import compose
from safeloc.language.expr import boolean, number, optional
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import never
from safeloc.language.units import MM, NM
from safeloc.target import Target

STANDS, MOVES = modes("STANDS", "MOVES")
CALM, ALERT = modes("CALM", "ALERT")
moved_mm, sum_mm = number("moved_mm", MM, 0, 1000), number("sum_mm", MM, 0, 1_000_000)
fine_nm = number("fine_nm", NM, 0, 9_000_000_000_000)
"""As long as the numbers of a true position."""
counter = Machine(
    name="counter",
    modes=(STANDS, MOVES),
    inputs=[moved_mm],
    state={sum_mm: 0, fine_nm: 4_421_563_453_096},
    outputs={"position_mm": sum_mm, "margin_below_mm": sum_mm + 500, "margin_above_mm": sum_mm + 500},
    transitions=[
        Transition(
            "move",
            (STANDS, MOVES),
            MOVES,
            (moved_mm > 0) & (sum_mm < 900_000),
            {sum_mm: sum_mm + moved_mm, fine_nm: fine_nm + 7},
        ),
        Transition("halt", MOVES, STANDS, moved_mm.eq(0)),
    ],
)
at_mm, quiet = number("at_mm", MM, 0, 1_001_000), boolean("quiet")
extra_mm = optional("extra_mm", MM, 0, 9000)
watcher = Machine(
    name="watcher",
    modes=(CALM, ALERT),
    inputs=[at_mm, quiet, extra_mm],
    state={},
    outputs={},
    transitions=[Transition("warn", CALM, ALERT, ~quiet & extra_mm.present & (at_mm > 100))],
)
whole = compose("tandem", (counter, watcher), {at_mm: counter.output("position_mm")})
FAR = never("far", whole.of(counter)(sum_mm > 800_000), statement="the sum stays below 800 m")
target = Target("tandem", (counter, watcher), whole.system, (FAR,))


def row(moved: int) -> dict[str, bool | int]:
    """The inputs of a step; `watcher.extra_mm` is absent in all of them."""
    return {"counter.moved_mm": moved, "watcher.quiet": False}


RUN = [row(0), row(300), row(300), row(0), row(200), *[row(100)] * 5]
