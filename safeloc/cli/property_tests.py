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
from safeloc.proof.verification.one import Plan, Work, obligation_count
from safeloc.proof.verification.unasked import nothing_tested


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
    with Progressing(obligation_count(loaded) + len(loaded.properties), quiet=as_json) as progress:
        work = Work(loaded, jobs, progress.say, progress.add)
        obliged = work.obliged(plan.limits)
        findings = [*nothing_tested(loaded), *work.tested(plan, obliged)]
    raise typer.Exit(result(findings, [loaded], as_json=as_json))
