"""The command `safeloc test`: property tests of one machine."""

from __future__ import annotations

import typer

from safeloc.catalogue import load_target
from safeloc.cli.options import (
    ConfigOption,
    ExamplesOption,
    JobsOption,
    JsonOption,
    SeedOption,
    StepsOption,
    TargetArgument,
)
from safeloc.cli.show import Progressing, result
from safeloc.proof.provers.limits import Limits
from safeloc.proof.verification.calls import expected_of_tests, run_property_tests
from safeloc.proof.verification.one import Plan


def test(
    target: TargetArgument,
    config: ConfigOption = None,
    examples: ExamplesOption = 100,
    steps: StepsOption = 60,
    jobs: JobsOption = 2,
    seed: SeedOption = 0,
    as_json: JsonOption = False,
) -> None:
    """Run property tests along plausible and faulty streams."""
    loaded = load_target(target, config)
    plan = Plan(Limits(), examples, steps, seed)
    with Progressing(expected_of_tests(loaded), quiet=as_json) as progress:
        findings = run_property_tests(loaded, plan, jobs=jobs, on_phase=progress.say, on_finding=progress.add)
    raise typer.Exit(result(findings, [loaded], as_json=as_json))
