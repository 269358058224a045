"""State and ghosts in the field's words: old names in a stream's first state are converted, others are left."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from safeloc.catalogue import ENTRIES
from safeloc.language.renamed import name_now, renamed
from tests.runtime.migration.migrating import migrated
from tests.shipped import shipped


@pytest.mark.parametrize(
    ("machine", "old", "new"),
    [
        ("odometry", "front_wheel_judged", "front_wheel_last_verdict"),
        ("odometry", "front_wheel_heard_mm", "front_wheel_last_delivered_mm"),
        ("reflector", "echo_1_judged_for_next", "echo_1_last_verdict_for_next"),
        ("reflector", "told_reflector_mm", "announced_reflector_mm"),
        ("guard", "judged", "last_verdict"),
        ("guard", "heard_low_nm", "last_fix_low_nm"),
        ("marker_device", "guard.judged", "guard.last_verdict"),
        ("localizer", "motion.distance_told", "motion.distance_reported"),
        ("localizer", "motion.told_more_nm", "motion.reported_more_nm"),
        ("balise", "reflector_told", "reflector_place_known"),
        ("balise", "charged_accuracy_mm", "added_accuracy_mm"),
        ("balise", "whole_run_measured", "complete_run_measured"),
        ("fibre", "told_run_error_nm", "measured_run_error_nm"),
        ("fibre_area", "report.run_since_whole_um", "report.run_since_complete_um"),
        ("sections", "section_1.told_with", "section_1.trust"),
        ("verification", "kept_axles", "stored_axles"),
        ("verification_doubted", "untold_for_cycles", "since_confirmed_cycles"),
    ],
)
def test_state_has_new_names(tmp_path: Path, machine: str, old: str, new: str) -> None:
    """A machine of today has the new name, and a stream of before is converted to it."""
    known = {var.name for var in shipped(machine).system.state}
    assert (new in known, old in known) == (True, False)
    assert f"; {old!r} is now {new!r}" == renamed([old], known)
    header = {"schema": "safeloc-stream/1", "first": {old: 0}}
    made = migrated(tmp_path / "run.jsonl", json.dumps(header) + "\n")
    assert {new: 0} == json.loads(made.text)["first"]


def test_outputs_have_new_names_where_a_machine_has_them() -> None:
    """In a stream the same words may name an input of somebody else's machine, so they are left there."""
    assert "; 'motion.told' is now 'motion.reported'" == renamed(["motion.told"], ["motion.reported"])
    assert "told" == name_now("told")


def test_no_machine_of_today_has_an_old_name() -> None:
    """Nothing that a machine declares would be taken for an old name."""
    for name in ENTRIES:
        system = shipped(name).system
        names = [*(var.name for var in (*system.state, *system.inputs)), *system.outputs]
        assert [one for one in names if name_now(one) != one] == [], name
