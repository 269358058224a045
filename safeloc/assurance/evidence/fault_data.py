"""The effects of broken clauses as data and in words, for the command, JSON and the report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from safeloc.assurance.evidence.cut_sets import CutSets
from safeloc.assurance.evidence.effects import CYCLES, Effect
from safeloc.assurance.law_ids import ids_of
from safeloc.proof.cores.clauses import laws
from safeloc.target import Target

SCHEMA = "safeloc-faults/1"


def end_in_words(target: Target, one: Effect) -> str:
    """Return the effect on the reported interval and on the hazard as a sentence."""
    hazard = target.hazard.text if target.hazard is not None else ""
    run = f"; shortest run: {cycles(one.run.cycles)}, ends with {one.run.fired!r}" if one.run is not None else ""
    match one.end:
        case "contained":
            kept = f"; proved never: {hazard}" if hazard else ""
            return f"the reported interval still contains the truth (proved){kept}"
        case "withdrawn":
            return f"a wrong interval is right again or withdrawn within {cycles(one.within_cycles)} (proved){run}"
        case "wrong":
            return f"the reported interval can miss the truth for more than {CYCLES[-1]} cycles{run}"
        case "hazard":
            return f"{hazard}{run}"
        case "no hazard":
            return f"proved never: {hazard}"
        case "undecided":
            return f"undecided within the limits{run}"
        case "no interval":
            return "none: the target reports no interval and declares no hazard"


def cycles(number: int) -> str:
    """Return a number of cycles in words."""
    return f"{number} cycle" if number == 1 else f"{number} cycles"


def faults_data(target: Target, effects: Sequence[Effect], sets: CutSets) -> dict[str, Any]:
    """Return the effects and the minimal cut sets as data for JSON."""
    numbers, declared = ids_of(target), laws(target.system)
    rows = []
    for one in effects:
        row = asdict(one)
        row["not_decided"] = row.pop("open_")
        row["end_effect"] = end_in_words(target, one)
        row["broken"] = [
            {
                "id": numbers[clause],
                **asdict(clause),
                "owner": declared[clause].owner,
                "statement": declared[clause].statement,
            }
            for clause in one.broken
        ]
        rows.append(row)
    sets_data = {
        "top": sets.top,
        "minimal": [[numbers[clause] for clause in one] for one in sets.found],
        "not_decided": [[numbers[clause] for clause in one] for one in sets.undecided],
    }
    return {"schema": SCHEMA, "target": target.name, "effects": rows, "cut_sets": sets_data}
