"""The strategies reach what they claim to reach: otherwise the comparisons of back ends would say little."""

from __future__ import annotations

import typing

from hypothesis import given
from hypothesis import strategies as st

from safeloc.language.interpret import run
from safeloc.language.machine import Machine
from safeloc.language.nodes import Node, Past
from safeloc.language.system import lower
from safeloc.language.terms import in_order
from tests.random_machines import machines, streams


def test_every_kind_of_node_is_drawn() -> None:
    """Random machines use every node kind that a machine may contain."""
    drawn: set[type[object]] = set()

    @given(machines())
    def collect(machine: Machine) -> None:
        system = lower(machine)
        drawn.update(type(node) for node in in_order([*system.next.values(), *system.outputs.values()]))

    collect()
    assert set(typing.get_args(Node)) - {Past} == drawn


def test_runs_leave_the_first_mode_and_fire_late_rows() -> None:
    """Random runs change modes, and fire transitions behind the first one of the table."""
    seen: set[str] = set()
    modes_seen: set[object] = set()

    @given(st.data())
    def collect(data: st.DataObject) -> None:
        system = lower(data.draw(machines()))
        for step in run(system, data.draw(streams(system))).steps:
            seen.add(step.fired["fired"])
            modes_seen.add(step.state["mode"])

    collect()
    assert {"(stay)", "t0", "t1", "t2"} <= seen
    assert {0, 1, 2} <= modes_seen
