"""The templates as they are: their own tests, which prove them and refuse wrong edits; every transition fires."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.language.verdict import word
from safeloc.proof.provers.limits import Limits
from safeloc.proof.verification.calls import prove_target
from safeloc.templates.project import TEMPLATES
from tests.started_pytest import run_pytest

ROOT = Path(__file__).parents[2] / "safeloc" / "templates"


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("template", TEMPLATES)
def test_every_transition_fires(template: str) -> None:
    """All holds of the template, and each transition has a run of its own."""
    target = load_target(TEMPLATES[template].target_in(ROOT / template))
    verdicts = {one.id: word(one.result) for one in prove_target(target, limits=Limits(seconds=10))}
    assert {"proved"} == set(verdicts.values())
    every = {f"transition {machine.name}: {one.name}" for machine in target.machines for one in machine.transitions}
    assert {f"{target.name}/obligation/{name}" for name in every} <= set(verdicts)
    assert len(every) >= 4


@pytest.mark.parametrize("template", [name for name in TEMPLATES if (ROOT / name / "recordings").is_dir()])
def test_the_recording_is_what_the_simulation_makes(template: str) -> None:
    """`make recording` would change nothing."""
    target = load_target(TEMPLATES[template].target_in(ROOT / template))
    assert target.simulate is not None
    from safeloc.runtime.streams.steps import read_steps

    assert list(read_steps(target.streams[0]).steps) == target.simulate(0)


@pytest.mark.thorough
@pytest.mark.parametrize("template", TEMPLATES)
def test_its_own_tests_hold(template: str) -> None:
    """Those that a new project gets, run where they stand: at least three wrong edits are refused by the proof."""
    done = run_pytest("-q", str(ROOT / template / "tests"), folder=ROOT.parents[1])
    assert done.returncode == 0, done.stdout
    assert " passed" in done.stdout
    (file,) = (ROOT / template / "tests").glob("test_*.py")
    assert file.read_text(encoding="utf-8").count('": (') >= 3
