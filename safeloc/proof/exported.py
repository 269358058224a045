"""A target as C code, as FMI unit and as script.

C and FMI come with the invariants that a restored state must satisfy, which are proved first.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping

from safeloc.codegen.c99 import to_c
from safeloc.codegen.fmu import to_fmu
from safeloc.codegen.javascript import javascript, on_board
from safeloc.language.expr import Bool
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.proof.drawn_runs.lawful import first_state
from safeloc.proof.drawn_runs.sampled import sampled_runs
from safeloc.proof.provers.lasting import lasting
from safeloc.runtime.embedding.cycle_length import configured_period_ms
from safeloc.target import Target

Say = Callable[[str], None]
"""A function that gets a line about the progress."""


def c_folder(target: Target, say: Say) -> Mapping[str, str]:
    """Return the files of C for the target, by name, with recorded runs to check them by."""
    runs = sampled_runs(target)
    return to_c(without_ghosts(target.system), runs, doc=target.doc, kept=_invariants(target.system, target.name, say))


def fmi_unit(target: Target, say: Say) -> bytes:
    """Return an FMI co-simulation unit; its period comes from the configuration, or from the machines."""
    on_board = without_ghosts(target.system)
    period_ms = configured_period_ms(target.name, target.config)
    first = first_state(on_board, random.Random(0))
    kept = _invariants(target.system, target.name, say)
    return to_fmu(on_board, period_ms=period_ms, first=first, doc=target.doc, kept=kept)


def script(target: Target) -> str:
    """Return the machine on board as a script for a browser or for node; its first state satisfies `initially`."""
    system = on_board(target.system)
    return javascript(system, first=first_state(system, random.Random(0)))


def _invariants(system: TransitionSystem, name: str, say: Say) -> Mapping[str, Bool] | None:
    """Return the invariants that a restored state must satisfy; None, and a warning, if not all ranges are proved."""
    say(f"{name}: proving the invariants for check_state")
    found = lasting(system)
    if found is None:
        say("not every range is proved: check_state checks ranges only, and a step may leave them")
    return found
