"""Modules that were moved or removed: an import by the old name is refused, and the message says what to do."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from types import ModuleType

MOVED = {
    "safeloc.antecedents": "safeloc.language.antecedents",
    "safeloc.assurance.mutation.claim_judging": "safeloc.assurance.mutation.judge_claim_mutant",
    "safeloc.assurance.mutation.judging": "safeloc.assurance.mutation.judge_machine_mutant",
    "safeloc.assurance.mutation.whole_judging": "safeloc.assurance.mutation.judge_composition_mutant",
    "safeloc.assurance.mutation.world_judging": "safeloc.assurance.mutation.judge_world_mutant",
    "safeloc.assurance.splits.live": "safeloc.assurance.splits.live_splits",
    "safeloc.audit": "safeloc.railway.audit",
    "safeloc.backends": "safeloc.codegen",
    "safeloc.border": "safeloc.runtime.border",
    "safeloc.cache": "safeloc.proof.cache",
    "safeloc.checker.runs": "safeloc.checker.run_checks",
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
    "safeloc.models.arbitration_parts": "safeloc.models.arbitration",
    "safeloc.models.area_parts": "safeloc.models.area",
    "safeloc.models.axle_counter_streams": "safeloc.models.axle_counter.simulate",
    "safeloc.models.axle_head_streams": "safeloc.models.axle_head.simulate",
    "safeloc.models.axle_parts": "safeloc.models.axle_counter",
    "safeloc.models.axle_section_streams": "safeloc.models.axle_section.simulate",
    "safeloc.models.balise_parts": "safeloc.models.balise",
    "safeloc.models.balise.recordings": "safeloc.models.balise.recorded_runs",
    "safeloc.models.balise_streams": "safeloc.models.balise.simulate",
    "safeloc.models.emitter_streams": "safeloc.models.emitter.simulate",
    "safeloc.models.fibre_area.border": "safeloc.models.fibre_handover.border",
    "safeloc.models.fibre_area.speaker": "safeloc.models.fibre_handover.speaker",
    "safeloc.models.fibre_area.recordings": "safeloc.models.fibre_area.recorded_runs",
    "safeloc.models.fibre_area_parts": "safeloc.models.fibre_area",
    "safeloc.models.fibre_area_streams": "safeloc.models.fibre_area.simulate",
    "safeloc.models.fibre_parts": "safeloc.models.fibre",
    "safeloc.models.fibre_scenes": "safeloc.models.fibre.scenes",
    "safeloc.models.fibre_streams": "safeloc.models.fibre.simulate",
    "safeloc.models.fibre_worked": "safeloc.models.fibre.worked",
    "safeloc.models.guard_parts": "safeloc.models.guard",
    "safeloc.models.guard_positions": "safeloc.models.guard.positions",
    "safeloc.models.guard_streams": "safeloc.models.guard.simulate",
    "safeloc.models.line_configs": "safeloc.models.line_runs.configs",
    "safeloc.models.line_drive": "safeloc.models.line_runs.drive",
    "safeloc.models.line_faults": "safeloc.models.line_runs.faults",
    "safeloc.models.line_placing": "safeloc.models.line_runs.placing",
    "safeloc.models.line_streams": "safeloc.models.line_runs.ways",
    "safeloc.models.localizer.simulation.recordings": "safeloc.models.localizer.simulation.recorded_runs",
    "safeloc.models.localizer_journeys": "safeloc.models.localizer.simulation.journeys",
    "safeloc.models.localizer_junction": "safeloc.models.localizer.simulation.junction",
    "safeloc.models.localizer_parts": "safeloc.models.localizer",
    "safeloc.models.localizer_picture": "safeloc.models.localizer.picture",
    "safeloc.models.localizer_recordings": "safeloc.models.localizer.simulation.recorded_runs",
    "safeloc.models.localizer_sections_streams": "safeloc.models.localizer_sections.simulate",
    "safeloc.models.localizer_sky": "safeloc.models.localizer.simulation.sky",
    "safeloc.models.localizer_streams": "safeloc.models.localizer.simulation.simulate",
    "safeloc.models.motion_streams": "safeloc.models.motion.simulate",
    "safeloc.models.odometry.error_law": "safeloc.models.vocabulary.error_law",
    "safeloc.models.odometry_parts": "safeloc.models.odometry",
    "safeloc.models.odometry_streams": "safeloc.models.odometry.simulate",
    "safeloc.models.reflector_device.line": "safeloc.models.reflector_anchor.line",
    "safeloc.models.reflector_parts": "safeloc.models.reflector",
    "safeloc.models.reflector_streams": "safeloc.models.reflector.simulate",
    "safeloc.models.route.recordings": "safeloc.models.route.recorded_runs",
    "safeloc.models.route_parts": "safeloc.models.route",
    "safeloc.models.route_streams": "safeloc.models.route.simulate",
    "safeloc.models.running": "safeloc.models.vocabulary",
    "safeloc.models.satellite.law": "safeloc.models.satellite.world",
    "safeloc.models.satellite_chain": "safeloc.models.satellite.chain",
    "safeloc.models.satellite_parts": "safeloc.models.satellite",
    "safeloc.models.satellite_streams": "safeloc.models.satellite.simulate",
    "safeloc.models.sections_streams": "safeloc.models.sections.simulate",
    "safeloc.models.stop_point_parts": "safeloc.models.stop_point",
    "safeloc.models.stop_point_streams": "safeloc.models.stop_point.simulate",
    "safeloc.models.train_ends": "safeloc.models.localizer_sections.train_ends",
    "safeloc.models.train_order_streams": "safeloc.models.train_order.simulate",
    "safeloc.models.train_seen": "safeloc.models.localizer_sections.train_seen",
    "safeloc.models.turn_off_streams": "safeloc.models.turn_off.simulate",
    "safeloc.models.verification_parts": "safeloc.models.verification",
    "safeloc.models.vocabulary.unit_check": "safeloc.models.motion.unit_check",
    "safeloc.monitor": "safeloc.language.monitor",
    "safeloc.nodes": "safeloc.language.nodes",
    "safeloc.outside": "safeloc.runtime.outside",
    "safeloc.packed": "safeloc.runtime.packed",
    "safeloc.pictures": "safeloc.railway.pictures",
    "safeloc.proof.checker": "safeloc.checker",
    "safeloc.proof.provers.base": "safeloc.proof.provers.proved_base",
    "safeloc.proof.provers.evidence": "safeloc.proof.provers.replayed_evidence",
    "safeloc.proof.provers.reading": "safeloc.proof.provers.z3_to_terms",
    "safeloc.proof.provers.recorded": "safeloc.proof.provers.recorded_witnesses",
    "safeloc.proof.provers.transfer": "safeloc.proof.provers.verdicts_as_data",
    "safeloc.proof.runs": "safeloc.proof.drawn_runs",
    "safeloc.properties.balise_layout": "safeloc.properties.balise.layout",
    "safeloc.properties.balise_linking": "safeloc.properties.balise.linking",
    "safeloc.properties.balise_step": "safeloc.properties.balise.step",
    "safeloc.properties.fibre_area_told": "safeloc.properties.fibre_area.told",
    "safeloc.properties.odometry_faults": "safeloc.properties.odometry.faults",
    "safeloc.properties.verification_mismatch": "safeloc.properties.verification.mismatch",
    "safeloc.provers": "safeloc.proof.provers",
    "safeloc.railway.guard.told": "safeloc.railway.guard.judgement_data",
    "safeloc.railway.audit.whole": "safeloc.railway.audit.all_rules",
    "safeloc.ranges": "safeloc.language.ranges",
    "safeloc.render": "safeloc.language.render",
    "safeloc.report.told": "safeloc.report.verdict_words",
    "safeloc.requirements": "safeloc.assurance.requirements",
    "safeloc.results": "safeloc.proof.results",
    "safeloc.runs": "safeloc.proof.drawn_runs",
    "safeloc.runtime.embedding.entries": "safeloc.runtime.embedding.row_layout",
    "safeloc.runtime.embedding.hearing": "safeloc.runtime.embedding.target_inputs",
    "safeloc.runtime.embedding.judging": "safeloc.runtime.embedding.readable_records",
    "safeloc.runtime.embedding.making": "safeloc.runtime.embedding.arguments",
    "safeloc.runtime.embedding.period": "safeloc.runtime.embedding.cycle_length",
    "safeloc.runtime.reported": "safeloc.reported",
    "safeloc.runtime.service.pace": "safeloc.runtime.service.clock_lag",
    "safeloc.sensing.fibre.runs": "safeloc.sensing.fibre.shaken_stretches",
    "safeloc.service": "safeloc.runtime.service",
    "safeloc.shipped": "safeloc.shipped_machines",
    "safeloc.shipped_machines.localizer": "safeloc.models.localizer.target",
    "safeloc.shipped_machines.making": "safeloc.target",
    "safeloc.shipped_machines.odometry": "safeloc.models.odometry.target",
    "safeloc.shipped_machines.receiver": "safeloc.models.guard.target",
    "safeloc.shipped_machines.satellite": "safeloc.models.satellite.target",
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
"""Old name -> new name, also for the modules below it, since Python imports the upper package first.

If one of these lower modules has another place, it has a row of its own.
"""

_A_FILE_EACH = (
    "it is gone. Each machine's entry stands in target.py of its folder, such as safeloc.models.emitter.target; "
    "safeloc.shipped_machines.ENTRIES has all of them."
)
_A_THEOREM = "it is gone. The machines of theorems about odometry are no part of the package; they stand in tests/theorems/odometry/ of the repository."
_THEOREMS = (
    "models.marker_field",
    "models.odometry.field",
    "models.odometry.front_only",
    "models.odometry.line_ahead",
    "models.odometry.marker_field",
    "models.odometry_front_only",
    "models.odometry_line_ahead",
    "properties.marker_field",
    "properties.odometry.front_only",
    "properties.odometry.marker_field",
    "properties.odometry_front_only",
)
GONE = {
    **{f"safeloc.{name}": _A_THEOREM for name in _THEOREMS},
    "safeloc.codegen.runtime": "to_fsm and to_async_fsm are gone. Controller(target).follow(model) of "
    "safeloc.runtime.embedding lets a host's object follow the machine, behind the border (docs/embedding.md).",
    "safeloc.shipped_machines.fibre": _A_FILE_EACH,
    "safeloc.shipped_machines.hosting": "SILENT and UNITS are gone. Entry.silent and Entry.records_of of safeloc.shipped_machines.ENTRIES state it "
    "of each machine; Entry.make hands it to the target.",
    "safeloc.shipped_machines.markers": _A_FILE_EACH,
}
"""Name of a removed module -> instructions for its users."""


class _OldNames(MetaPathFinder):
    """Refuses old names before any other finder, since a folder left behind by an update would pass for an empty package."""

    def find_spec(self, name: str, _path: Sequence[str] | None, _target: ModuleType | None = None) -> None:
        """Find nothing; ImportError for the old name of a moved module, and for a removed one."""
        if name in GONE:
            raise ImportError(f"{name}: {GONE[name]}", name=name)
        if name in MOVED:
            raise ImportError(f"{name} is now {MOVED[name]}; import it from there.", name=name)


def refuse_old_names() -> None:
    """Refuse every import by an old name with a message that gives the new one."""
    sys.meta_path.insert(0, _OldNames())
