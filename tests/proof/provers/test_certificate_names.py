"""Certificates of one report never share a name: each names its system."""

from __future__ import annotations

from safeloc.language.composition import compose
from safeloc.language.expr import Expr, Var, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import MM
from safeloc.proof.provers.proved_base import base
from safeloc.shipped_machines import ENTRIES
from tests.shipped import shipped

IDLE, BUSY = modes("IDLE", "BUSY")


def counting(limit: int) -> Machine:
    """A machine that counts to its limit."""
    level = number("level", MM, 0, 20)
    rise = Transition("rise", IDLE, IDLE, level < limit, {level: level + 1})
    return Machine(
        "counting", (IDLE, BUSY), [], {level: 0}, {"level": level}, [rise], lemmas={"within limit": level <= limit}
    )


def whole(name: str, limit: int) -> TransitionSystem:
    """The counting machine and a listener behind it."""
    source, heard, kept = counting(limit), number("heard", MM, 0, 20), number("kept", MM, 0, 20)
    keep = Transition("keep", IDLE, IDLE, set={kept: heard})
    listener = Machine("listener", (IDLE, BUSY), [heard], {kept: 0}, {"kept": kept}, [keep])
    wires: dict[Var, Expr] = {heard: source.output("level")}
    return compose(name, [source, listener], wires).system


def test_one_machine_in_two_wholes() -> None:
    """A machine with other figures in two compositions, and by itself, leaves certificates of different names."""
    found = [base(system).certificates for system in (lower(counting(9)), whole("one", 10), whole("other", 11))]
    names = [name for certificates in found for name in certificates]
    assert all(found)
    assert len(names) == len(set(names)), sorted(names)
    assert any(name.startswith("other-counting") for name in found[2])


def test_every_shipped_system_has_a_name_of_its_own() -> None:
    """Two targets of one name would overwrite each other's evidence."""
    names = [shipped(name).system.name for name in ENTRIES]
    assert len(names) == len(set(names)), sorted(names)
