"""The proof cores of a target, and the effects of broken clauses, as data for the report."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from safeloc.assurance.evidence.core_work import as_data
from safeloc.assurance.evidence.cut_sets import cut_sets
from safeloc.assurance.evidence.effects import Effect
from safeloc.assurance.evidence.fault_data import faults_data
from safeloc.assurance.evidence.top_event import top_event
from safeloc.assurance.law_ids import ids_of
from safeloc.proof.cores.cores import Core
from safeloc.report.fault_tree import fault_tree
from safeloc.target import Target


def evidence_data(target: Target, cores: Sequence[Core], effects: Sequence[Effect]) -> dict[str, Any]:
    """Return the cores of all claims, the effects of broken clauses, and the picture of the cut sets ("" without a top event)."""
    sets = cut_sets(top_event(target), effects)
    data = as_data(target, cores, complete=True)
    found = {
        "cores": [{**one, "rows_of": _row_count(target, one["kept_by"])} for one in data["cores"]],
        "needed_by_none": data["needed_by_none"],
        "faults": faults_data(target, effects, sets),
        "picture": "" if not sets.top else fault_tree(target.name, sets, ids_of(target)),
    }
    plain: dict[str, Any] = json.loads(json.dumps(found))
    return plain


def _row_count(target: Target, kept_by: str) -> int:
    """Return the number of rows of the machine on which the claim was proved."""
    return sum(len(machine.transitions) for machine in target.machines if kept_by in ("", machine.name))
