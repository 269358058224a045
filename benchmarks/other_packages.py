"""The odometer in three state machine packages, each used as its own documentation shows."""
# ruff: noqa: ARG002 # every guard and action gets all inputs of the step

from __future__ import annotations

from typing import Any

import sismic.interpreter
import sismic.io
import transitions
from statemachine import State, StateMachine

from benchmarks.by_hand import RATE_PPM, TOLERANCE_NM
from benchmarks.odometer import Last, Row
from tests.examples import LINE_MM

MODES = ("TRACKING", "DELOCALIZED")


class Odometer:
    """Guards and actions, called by `transitions`."""

    state: str
    tick: Any

    def __init__(self) -> None:
        self.position = 0
        self.margin = 0

    def referenced(self, movement: int, present: bool, reference: int) -> bool:
        """A reference is there."""
        return present

    def too_wide(self, movement: int, present: bool, reference: int) -> bool:
        """The margin would exceed the tolerance."""
        return self.margin + abs(movement) * RATE_PPM > TOLERANCE_NM

    def off_line(self, movement: int, present: bool, reference: int) -> bool:
        """The position would leave the line."""
        return not -LINE_MM <= self.position + movement <= LINE_MM

    def take(self, movement: int, present: bool, reference: int) -> None:
        """Position from the reference."""
        self.position = reference
        self.margin = 0

    def run_on(self, movement: int, present: bool, reference: int) -> None:
        """Position by the movement."""
        self.position += movement
        self.margin += abs(movement) * RATE_PPM


def bare_transitions() -> Odometer:
    """The odometer as a `transitions` model."""
    model = Odometer()
    fsm = transitions.Machine(model, states=list(MODES), initial="TRACKING", auto_transitions=False)
    fsm.add_transition("tick", "TRACKING", None, conditions=model.referenced, after=model.take)
    fsm.add_transition("tick", "DELOCALIZED", "TRACKING", conditions=model.referenced, after=model.take)
    fsm.add_transition("tick", "TRACKING", "DELOCALIZED", conditions=model.too_wide)
    fsm.add_transition("tick", "TRACKING", "DELOCALIZED", conditions=model.off_line)
    fsm.add_transition("tick", "TRACKING", None, after=model.run_on)
    return model


def run_bare_transitions(rows: list[Row]) -> Last:
    """The stream through it."""
    model = bare_transitions()
    for movement, present, reference in rows:
        model.tick(movement, present, reference)
    return MODES.index(model.state), model.position, model.margin


class PythonStateMachine(StateMachine):
    """The odometer in python-statemachine."""

    allow_event_without_transition = True

    tracking = State(initial=True)
    delocalized = State()
    tick = (
        tracking.to(tracking, internal=True, cond="referenced", on="take")
        | delocalized.to(tracking, cond="referenced", on="take")
        | tracking.to(delocalized, cond="too_wide")
        | tracking.to(delocalized, cond="off_line")
        | tracking.to(tracking, internal=True, on="run_on")
    )

    position = 0
    margin = 0

    referenced, too_wide, off_line = Odometer.referenced, Odometer.too_wide, Odometer.off_line
    take, run_on = Odometer.take, Odometer.run_on


def run_python_statemachine(rows: list[Row]) -> Last:
    """The stream through it."""
    machine = PythonStateMachine()
    for movement, present, reference in rows:
        machine.send("tick", movement=movement, present=present, reference=reference)
    return int(not machine.tracking.is_active), machine.position, machine.margin


STATECHART = f"""
statechart:
  name: odometer
  preamble: |
    position = 0
    margin = 0
  root state:
    name: root
    initial: TRACKING
    states:
      - name: TRACKING
        transitions:
          - {{event: tick, guard: "event.present", action: "position = event.reference; margin = 0", priority: 4}}
          - {{event: tick, guard: "margin + abs(event.movement) * {RATE_PPM} > {TOLERANCE_NM}", target: DELOCALIZED,
             priority: 3}}
          - {{event: tick, guard: "not -{LINE_MM} <= position + event.movement <= {LINE_MM}", target: DELOCALIZED,
             priority: 2}}
          - {{event: tick, action: "position += event.movement; margin += abs(event.movement) * {RATE_PPM}",
             priority: 1}}
      - name: DELOCALIZED
        transitions:
          - {{event: tick, guard: "event.present", target: TRACKING, action: "position = event.reference; margin = 0"}}
"""


def run_sismic(rows: list[Row]) -> Last:
    """The stream through sismic."""
    interpreter = sismic.interpreter.Interpreter(sismic.io.import_from_yaml(STATECHART))
    interpreter.execute_once()
    for movement, present, reference in rows:
        interpreter.queue("tick", movement=movement, present=present, reference=reference)
        interpreter.execute_once()
    mode = int("DELOCALIZED" in interpreter.configuration)
    return mode, interpreter.context["position"], interpreter.context["margin"]
