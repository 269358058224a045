"""A target as C code, as FMI unit and as script.

C and FMI come with the invariants that a restored state must satisfy, which are proved first.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from importlib.metadata import version

from safeloc.codegen.c99 import to_c
from safeloc.codegen.c99_origin import Figure, Origin
from safeloc.codegen.fmu import to_fmu
from safeloc.codegen.javascript import javascript, on_board
from safeloc.language.expr import Bool
from safeloc.language.system import without_ghosts
from safeloc.proof.drawn_runs.lawful import first_state
from safeloc.proof.drawn_runs.sampled import sampled_runs
from safeloc.proof.provers.lasting import lasting
from safeloc.runtime.embedding.cycle_length import configured_period_ms
from safeloc.runtime.streams.meanings import meanings_of_inputs
from safeloc.target import Target

Say = Callable[[str], None]
"""A function that gets a line of text."""
PHASES = 3
"""The largest number of phases of an export."""


def c_folder(target: Target, say: Say, warn: Say) -> Mapping[str, str]:
    """Return the files of C for the target, by name, with recorded runs to check them by.

    say   is told the beginning of each phase
    warn  is told what could not be proved
    """
    kept = _invariants(target, say, warn)
    say(f"{target.name}: recorded, simulated and drawn runs for the self-check")
    runs = sampled_runs(target)
    say(f"{target.name}: writing C, and every step of the runs")
    return to_c(without_ghosts(target.system), runs, doc=target.doc, kept=kept, origin=_origin(target))


def fmi_unit(target: Target, say: Say, warn: Say) -> bytes:
    """Return an FMI co-simulation unit; its period comes from the configuration, or from the machines.

    `say` and `warn` are as for `c_folder`.
    """
    on_board = without_ghosts(target.system)
    period_ms = configured_period_ms(target.name, target.config)
    first = first_state(on_board, random.Random(0))
    kept = _invariants(target, say, warn)
    say(f"{target.name}: writing and compiling C")
    return to_fmu(on_board, period_ms=period_ms, first=first, doc=target.doc, kept=kept, origin=_origin(target))


def _origin(target: Target) -> Origin:
    """Return what the target was made of, for the header and the README."""
    return Origin(
        version("safeloc"),
        target.configuration or ("" if target.config_file is None else target.config_file.name),
        [Figure(row["name"], row["value"], row["unit"]) for row in target.figures],
        configured_period_ms(target.name, target.config),
        {**meanings_of_inputs(target), **({} if target.reported is None else target.reported.meanings)},
    )


def script(target: Target) -> str:
    """Return the machine on board as a script for a browser or for node; its first state satisfies `initially`."""
    system = on_board(target.system)
    return javascript(system, first=first_state(system, random.Random(0)))


def _invariants(target: Target, say: Say, warn: Say) -> Mapping[str, Bool] | None:
    """Return the invariants that a state must satisfy; None, and a warning, if not all ranges are proved."""
    say(f"{target.name}: proving the invariants that every state is checked by")
    found = lasting(target.system)
    if found is None:
        warn("not every range is proved: check_state checks ranges only, and a step may leave them")
    return found
