"""The command `safeloc prove`: properties and obligations of one machine, in one configuration or in several."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer
from pydantic import BaseModel

from safeloc.catalogue import Target, configured, load_target
from safeloc.cli.around import AroundOptions, Proving, prove_around
from safeloc.cli.console import out, print_json
from safeloc.cli.keeping import CacheOption, FreshOption, print_cached, store_in
from safeloc.cli.options import (
    ConfigOption,
    DepthOption,
    JobsOption,
    JsonOption,
    SecondsOption,
    SeedOption,
    TargetArgument,
)
from safeloc.cli.show import Progressing, code, print_summary, result, summed_up
from safeloc.cli.watching import WatchOption, beside, watch
from safeloc.config import Config
from safeloc.errors import InputError
from safeloc.proof.cache.store import Store
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding
from safeloc.proof.verification.calls import chosen_properties, expected_of_proof, prove_target
from safeloc.report.data import report_data


def prove(
    target: TargetArgument,
    config: ConfigOption = None,
    only: Annotated[
        list[str] | None,
        typer.Option("--property", help="only this property (repeatable), and whether the assumption can be kept"),
    ] = None,
    configurations: Annotated[
        list[str] | None,
        typer.Option(
            "--configurations",
            help="instead of the defaults: `all` declared configurations of a shipped machine, or the name of one (repeatable)",
        ),
    ] = None,
    depth: DepthOption = 25,
    seconds: SecondsOption = 30.0,
    jobs: JobsOption = 2,
    seed: SeedOption = 0,
    cache: CacheOption = None,
    fresh: FreshOption = False,
    again: WatchOption = False,
    as_json: JsonOption = False,
    around: Annotated[
        str | None,
        typer.Option(
            "--around", help="prove for all streams near this one: a file, or the name of a recording that ships"
        ),
    ] = None,
    simulate: Annotated[
        str | None,
        typer.Option("--simulate", help="the same near a simulated stream: seed=7, or line=fig3,seed=7,faults=..."),
    ] = None,
    within: Annotated[
        list[str] | None,
        typer.Option("--within", help="around: NAME=WIDTH,... how far inputs may deviate, in their units (repeatable)"),
    ] = None,
    drop: Annotated[
        list[str] | None,
        typer.Option(
            "--drop", help="around: NAME=N, N values of an input may be missing; A+B=N of one message (repeatable)"
        ),
    ] = None,
    delay: Annotated[
        list[str] | None,
        typer.Option(
            "--delay", help="around: NAME=N, values may come up to N cycles late; A+B=N together (repeatable)"
        ),
    ] = None,
    claims: Annotated[
        list[str] | None,
        typer.Option(
            "--claim", help="around: a condition of your own, such as 'valid and margin_mm <= 900' (repeatable)"
        ),
    ] = None,
    first: Annotated[int | None, typer.Option("--from", help="around: first cycle in which claims are judged")] = None,
    last: Annotated[int | None, typer.Option("--until", help="around: last cycle in which claims are judged")] = None,
    without: Annotated[
        list[str] | None, typer.Option("--without", help="around: leave out this law of the world (repeatable)")
    ] = None,
    timeout: Annotated[
        float | None,
        typer.Option(
            "--timeout",
            help="around: limit of effort for the whole question, in seconds as --seconds has them",
            min=1.0,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", help="around: folder for pictures of the tube, streams that break a claim, certificates"),
    ] = None,
) -> None:
    """Prove the properties and obligations of a machine for all streams that obey its assumption, or for those near one."""
    near = AroundOptions(
        around, simulate, tuple(within or ()), tuple(drop or ()), tuple(delay or ()), tuple(claims or ()), first, last,
        tuple(without or ()), out, timeout,
    )  # fmt: skip
    if around is not None or simulate is not None:
        if again or configurations is not None:
            raise typer.BadParameter("--around and --simulate go with neither --watch nor --configurations.")
        limits = Limits(depth=depth, seconds=seconds, seed=seed)
        raise typer.Exit(prove_around(target, near, Proving(config, only, limits, store_in(cache), as_json)))
    if near.named():
        raise typer.BadParameter(f"{near.named()[0]} speaks of streams near one: give it with --around or --simulate.")
    if again:
        raise typer.Exit(watch(sys.argv[1:], beside([target], config)))
    proving = _Proving(only, Limits(depth=depth, seconds=seconds, seed=seed), jobs, store_in(cache), fresh, as_json)
    if configurations is None:
        loaded = load_target(target, config)
        raise typer.Exit(result(proving.findings(loaded), [loaded], as_json=as_json))
    if config is not None:
        raise typer.BadParameter(
            "--config and --configurations exclude each other: give a file, or names of declared configurations."
        )
    raise typer.Exit(proving.in_each(configured(target, configurations)))


@dataclass(frozen=True)
class _Proving:
    """The options of a proof: properties, limits, processes and cache."""

    only: list[str] | None
    limits: Limits
    jobs: int
    store: Store
    fresh: bool
    quiet: bool

    def findings(self, loaded: Target) -> list[Finding]:
        """Prove one target, or return what an earlier run found."""
        _require_known(loaded, self.only)
        with Progressing(expected_of_proof(loaded, self.only), quiet=self.quiet) as progress:
            found = prove_target(
                loaded,
                only=self.only,
                limits=self.limits,
                jobs=self.jobs,
                store=self.store,
                fresh=self.fresh,
                on_phase=progress.say,
                on_finding=progress.add,
            )
        print_cached(found, quiet=self.quiet)
        return found

    def in_each(self, configured: Iterable[tuple[str, Target]]) -> int:
        """Prove a machine in each of its configurations; return the exit code of the worst finding."""
        every: dict[str, list[Finding]] = {}
        reports: dict[str, Any] = {}
        for name, loaded in configured:
            self._print_head(name, loaded)
            every[name] = self.findings(loaded)
            if self.quiet:
                reports[name] = report_data(every[name], [loaded])
            else:
                print_summary(every[name], [loaded])
        if self.quiet:
            print_json({"configurations": reports})
        else:
            self._print_table(every)
        return code([finding for findings in every.values() for finding in findings])

    def _print_head(self, name: str, loaded: Target) -> None:
        if not self.quiet:
            out.print(f"\n{loaded.name}, {name}: {changed_figures(loaded.config)}", markup=False)

    def _print_table(self, every: Mapping[str, Sequence[Finding]]) -> None:
        out.print("")
        for name, findings in every.items():
            out.print(f"{name:30}  {summed_up(findings)}", markup=False)


def changed_figures(config: BaseModel | None) -> str:
    """Return the figures of a configuration that differ from the machine's defaults, in words."""
    changed = {} if config is None else _unlike_the_defaults(config)
    return ", ".join(f"{name} = {value}" for name, value in changed.items()) or "all figures are defaults"


def _unlike_the_defaults(config: BaseModel) -> dict[str, Any]:
    """Return the figures that differ from the defaults; those of a class derived from a machine's configuration count as changed."""
    plain = type(config).__bases__[0]
    if plain is Config or not issubclass(plain, Config):
        return config.model_dump(mode="json", exclude_defaults=True)
    defaults = plain().model_dump(mode="json")
    return {name: value for name, value in config.model_dump(mode="json").items() if defaults.get(name) != value}


def _require_known(target: Target, names: Sequence[str] | None) -> None:
    """Refuse a name in --property that the target has not."""
    try:
        chosen_properties(target, names)
    except InputError as error:
        raise typer.BadParameter(str(error)) from error
