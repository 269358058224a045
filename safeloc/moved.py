"""Modules that have moved: an import by the old name is refused, and the message says the new one."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from types import ModuleType

MOVED = {
    "safeloc.antecedents": "safeloc.language.antecedents",
    "safeloc.audit": "safeloc.railway.audit",
    "safeloc.backends": "safeloc.codegen",
    "safeloc.border": "safeloc.runtime.border",
    "safeloc.cache": "safeloc.proof.cache",
    "safeloc.checker": "safeloc.proof.checker",
    "safeloc.checks": "safeloc.language.checks",
    "safeloc.codegen.known": "safeloc.codegen.simplify_under_facts",
    "safeloc.codegen.live": "safeloc.codegen.dead_code",
    "safeloc.codegen.python_blocks": "safeloc.codegen.nested_statements",
    "safeloc.codegen.python_cases": "safeloc.codegen.case_splitting",
    "safeloc.codegen.shapes": "safeloc.codegen.merge_choices",
    "safeloc.codegen.writing": "safeloc.codegen.naming_terms",
    "safeloc.composition": "safeloc.language.composition",
    "safeloc.digest": "safeloc.language.digest",
    "safeloc.embedding": "safeloc.runtime.embedding",
    "safeloc.expr": "safeloc.language.expr",
    "safeloc.folding": "safeloc.language.folding",
    "safeloc.guard": "safeloc.railway.guard",
    "safeloc.interpret": "safeloc.language.interpret",
    "safeloc.line": "safeloc.railway.map",
    "safeloc.machine": "safeloc.language.machine",
    "safeloc.monitor": "safeloc.language.monitor",
    "safeloc.nodes": "safeloc.language.nodes",
    "safeloc.outside": "safeloc.runtime.outside",
    "safeloc.packed": "safeloc.runtime.packed",
    "safeloc.pictures": "safeloc.railway.pictures",
    "safeloc.proof.provers.base": "safeloc.proof.provers.proved_base",
    "safeloc.proof.provers.evidence": "safeloc.proof.provers.replayed_evidence",
    "safeloc.proof.provers.reading": "safeloc.proof.provers.z3_to_terms",
    "safeloc.proof.provers.recorded": "safeloc.proof.provers.recorded_witnesses",
    "safeloc.proof.provers.transfer": "safeloc.proof.provers.verdicts_as_data",
    "safeloc.provers": "safeloc.proof.provers",
    "safeloc.ranges": "safeloc.language.ranges",
    "safeloc.render": "safeloc.language.render",
    "safeloc.reported": "safeloc.runtime.reported",
    "safeloc.requirements": "safeloc.assurance.requirements",
    "safeloc.results": "safeloc.proof.results",
    "safeloc.runs": "safeloc.proof.runs",
    "safeloc.runtime.embedding.entries": "safeloc.runtime.embedding.row_layout",
    "safeloc.runtime.embedding.hearing": "safeloc.runtime.embedding.target_inputs",
    "safeloc.runtime.embedding.judging": "safeloc.runtime.embedding.readable_records",
    "safeloc.runtime.embedding.making": "safeloc.runtime.embedding.arguments",
    "safeloc.runtime.embedding.period": "safeloc.runtime.embedding.cycle_length",
    "safeloc.runtime.service.pace": "safeloc.runtime.service.clock_lag",
    "safeloc.service": "safeloc.runtime.service",
    "safeloc.signals": "safeloc.sensing",
    "safeloc.spec": "safeloc.language.spec",
    "safeloc.streams": "safeloc.runtime.streams",
    "safeloc.system": "safeloc.language.system",
    "safeloc.terms": "safeloc.language.terms",
    "safeloc.testing": "safeloc.proof.testing",
    "safeloc.trace": "safeloc.language.trace",
    "safeloc.units": "safeloc.language.units",
    "safeloc.verdict": "safeloc.language.verdict",
    "safeloc.verification": "safeloc.proof.verification",
}
"""Old name -> new name; what stood below the old one stands below the new one. Python asks for the upper one first."""


class OldNames(MetaPathFinder):
    """Asked before any other finder, since a folder that an update left behind would pass for an empty package."""

    def find_spec(self, name: str, _path: Sequence[str] | None, _target: ModuleType | None = None) -> None:
        """Find nothing. ImportError for a name of before the move."""
        if name in MOVED:
            raise ImportError(f"{name} is now {MOVED[name]}; import it from there.", name=name)


def refuse_old_names() -> None:
    """Let every import by an old name tell the new one."""
    sys.meta_path.insert(0, OldNames())
