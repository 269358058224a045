"""Simulated deliveries of a receiver and its vehicle, which obey the guard's law, with the true place and speed.

Fixes come every few steps, with errors along the track up to their bound, mostly equal to it. Faults come in spells:
positions off the track, jumps along it that last fewer than `confirmations` fixes, courses across it or against its
direction, silence, and records without a fix. The vehicle never runs backwards; the host gives one new start.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from random import Random

from safeloc.language.nodes import Value
from safeloc.language.units import NM_PER_MM
from safeloc.models.guard.variables import FAULT, GuardConfig

FIX_EVERY_MS = 400
SPELLS = ("sound", "off track", "jump", "silence", "no fix", "ambiguous", "across", "backwards")
OFF_BY_MM, JUMP_MM, ACROSS_MRAD, BACKWARDS_MRAD = 150_000, 180_000, 600, 3_000
_START_ANEW_MS = 50_000
"""Time of the host's new start after the beginning."""
NO_FIX = next(number for number, fault in enumerate(FAULT) if fault.label == "NO_FIX")


@dataclass
class _Vehicle:
    """True movement: place, speed, and the change of speed in each of the next `steps` steps."""

    place_nm: int
    speed_um_s: int
    change_um_s: int = 0
    steps: int = 0


FIRST_TRUTH: Mapping[str, Value] = {"truth_nm": 0, "true_speed_um_s": 0}
"""Place of the vehicle before the first step, at rest."""


def simulate(config: GuardConfig | None = None, *, seed: int, seconds: int = 240) -> list[dict[str, Value]]:
    """Return steps with the inputs of the machine and its world, from rest at place 0; the first spell is sound."""
    config = config or GuardConfig()
    random, vehicle = Random(seed), _Vehicle(0, 0)
    every = max(1, FIX_EVERY_MS // config.period_ms)
    spells = _spells(config, random)
    made = []
    spell = next(spells)
    for number in range(seconds * 1_000 // config.period_ms):
        _move(vehicle, config, random)
        step = _quiet(vehicle)
        if number % every == 0:
            spell = spell if spell.fixes else next(spells)
            spell.fixes -= 1
            step |= _delivered(vehicle, config, random, spell)
        made.append(step | {"start_anew": number == _START_ANEW_MS // config.period_ms})
    return made


@dataclass
class _Spell:
    """Behaviour of the receiver for some fixes."""

    kind: str
    fixes: int
    jump_mm: int


def _spells(config: GuardConfig, random: Random) -> Iterator[_Spell]:
    """Yield sound and faulty spells by turns; a jump along the track lasts fewer than `confirmations` fixes."""
    while True:
        yield _Spell("sound", random.randint(3 * config.confirmations, 12 * config.confirmations), 0)
        kind = random.choice(SPELLS[1:])
        longest = config.confirmations - 1 if kind == "jump" else 4 * config.confirmations
        yield _Spell(kind, random.randint(1, longest), random.choice((-JUMP_MM, JUMP_MM)))


def _move(vehicle: _Vehicle, config: GuardConfig, random: Random) -> None:
    """Move the vehicle by one step: it keeps its speed, accelerates or brakes for a random time."""
    if not vehicle.steps:
        vehicle.change_um_s = random.choice((-config.speed_change_um_s, 0, config.speed_rise_um_s))
        vehicle.steps = random.randint(1, 10_000 // config.period_ms)
    vehicle.steps -= 1
    most = config.max_speed_mm_s * 1_000
    after = min(max(vehicle.speed_um_s + vehicle.change_um_s, 0), most)
    vehicle.place_nm += (vehicle.speed_um_s + after) * config.period_ms // 2
    vehicle.speed_um_s = after


def _quiet(vehicle: _Vehicle) -> dict[str, Value]:
    return {
        "advance": True, "fault": 0, "fix_offset_mm": 0, "fix_age_ms": 0, "fix_ambiguous": False, "fix_elsewhere": False,
        "forwards_only": True, "start_anew": False, "next_truth_nm": vehicle.place_nm, "next_speed_um_s": vehicle.speed_um_s,
    }  # fmt: skip


def _delivered(vehicle: _Vehicle, config: GuardConfig, random: Random, spell: _Spell) -> dict[str, Value]:
    """Return the inputs of one delivery, as the spell demands; none while the receiver is silent."""
    if spell.kind in ("silence", "no fix"):
        return {} if spell.kind == "silence" else {"fault": NO_FIX}
    offset = random.choice((0, random.randint(0, config.offset_limit_mm), config.offset_limit_mm))
    error_bound = config.fix_error_mm + offset * config.offset_charge_permille // 1_000
    error = random.choice((-error_bound, error_bound, random.randint(-error_bound, error_bound))) * NM_PER_MM
    place = (vehicle.place_nm + error) // NM_PER_MM + (0 if error > 0 else 1)
    inputs: dict[str, Value] = {"fix_mm": place, "fix_offset_mm": offset, "fix_ambiguous": spell.kind == "ambiguous"}
    match spell.kind:
        case "off track":
            inputs |= {"fix_offset_mm": OFF_BY_MM}
        case "jump":
            inputs |= {"fix_mm": place + spell.jump_mm}
        case "across" | "backwards":
            inputs |= {
                "fix_mm": place + spell.jump_mm // 2,
                "fix_course_mrad": ACROSS_MRAD if spell.kind == "across" else BACKWARDS_MRAD,
            }
        case _ if random.random() < 0.5:
            inputs |= {"fix_course_mrad": random.randint(0, config.course_limit_mrad)}
    return inputs | ({"fix_speed_mm_s": vehicle.speed_um_s // 1_000} if random.random() < 0.5 else {})
