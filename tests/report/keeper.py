"""A machine that names its terms, and breaks a claim after four counts: what the page shows of it is told by hand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from safeloc.catalogue import Target
from safeloc.language.expr import boolean, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import never, once, within
from safeloc.language.system import lower
from safeloc.language.units import COUNT, MS
from safeloc.runtime.streams.steps import write_steps

OFF, ON = modes("OFF", "ON")
go, age_ms = boolean("go"), number("age_ms", MS, 0, 90_000)
counted = number("counted", COUNT, 0, 1000)
is_young = age_ms <= 1000
may_start = go & (age_ms <= 1000)
machine = Machine(
    name="keeper",
    modes=(OFF, ON),
    inputs=[go, age_ms],
    state={counted: 0},
    outputs={"counted": counted},
    transitions=[
        Transition("start", OFF, ON, may_start & (counted < 900), {counted: counted + 1}),
        Transition("stop", ON, OFF, ~is_young, {counted: 0}, rank=0),
        Transition("count", ON, ON, counted < 900, {counted: counted + 1}, rank=1),
    ],
    definitions={"age within limit": is_young, "may start": may_start},
)
MANY = never("four counts", (counted > 3) & machine.mode.eq(ON), statement="at most 3 counts, in 1000 ms")
LATE = within("off soon", 6, once(machine.mode.eq(ON)), machine.mode.eq(OFF))
target = Target("keeper", (machine,), lower(machine), (MANY, LATE), doc=machine.doc)


def row(go_: bool, age: int) -> dict[str, bool | int]:
    """The inputs of a step."""
    return {"go": go_, "age_ms": age}


QUIET = [row(False, 1200), row(True, 1200), row(True, 900), row(False, 100), row(False, 1500), *[row(False, 50)] * 20]
"""It is refused twice, starts, counts, and stops before anything is violated."""
BUSY = [row(True, 900), *[row(False, 100)] * 9]
"""It counts until the claim is violated in step 4."""


def stream(folder: Path, name: str, steps: Sequence[Mapping[str, bool | int]]) -> Path:
    """A stream of the machine."""
    path = folder / f"{name}.jsonl"
    write_steps(path, steps, machine="keeper")
    return path
