"""The reflector behind a facing switch, as the course at switches sees it on a simulated journey: what the radar measures, and the truth."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.language.nodes import Value
from safeloc.language.units import NM_PER_MM
from safeloc.models.turn_off import TurnOffConfig
from safeloc.models.turn_off.simulate import SwitchAhead, shift_mm
from safeloc.runtime.streams.steps import Cell

_VIEW_MM = 100_000
"""How far before the switch its reflector is in view."""
_BEYOND_MM = 60_000
"""How far beyond the switch it stays in view."""


def seen(
    config: TurnOffConfig, switch: SwitchAhead | None, truth_nm: int, high_mm: int | None, watched: bool
) -> dict[str, Cell]:
    """Return inputs and ghosts of a cycle, by their names in the machine.

    high_mm  upper end of the interval that the map is asked with; None while there is no position, and so no switch
    watched  the machine watches the switch already
    """
    if switch is None:
        return _nothing()
    beyond = truth_nm // NM_PER_MM - switch.position_mm
    in_view = -_VIEW_MM <= beyond <= _BEYOND_MM
    given = in_view and not watched and high_mm is not None and high_mm < switch.position_mm
    measured, shift = in_view and (watched or given), shift_mm(config, switch, truth_nm)
    cells: dict[str, Cell] = {
        "reflector_measured": measured,
        "lateral_mm": switch.lateral_mm + shift if measured else 0,
        "authorised_course": "UNDECIDED",
        "next_true_course": switch.course,
        "next_true_lateral_mm": switch.lateral_mm,
        "true_shift_mm": shift,
    }
    return {**cells, "switch_position_mm": switch.position_mm} if given else cells


def watches(state: Mapping[str, Value], switch: SwitchAhead | None) -> bool:
    """Return whether the machine watches the switch, from the state of the composition."""
    return switch is not None and state["turn_off.switch_here_mm"] == switch.position_mm


def _nothing() -> dict[str, Cell]:
    """Return the inputs of a vehicle that sees no reflector behind a switch."""
    return {
        "reflector_measured": False, "lateral_mm": 0, "authorised_course": "UNDECIDED",
        "next_true_course": "STRAIGHT", "next_true_lateral_mm": 0, "true_shift_mm": 0,
    }  # fmt: skip
