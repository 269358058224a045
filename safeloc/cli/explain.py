"""The command `safeloc explain`: one property in words, how it was decided, and what its verdict rests on."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from safeloc.assurance.evidence.core_work import cores_of
from safeloc.assurance.mutation.strength import kept_strengths
from safeloc.catalogue import Target, configured, load_target
from safeloc.cli.console import err, out, print_line
from safeloc.cli.keeping import CacheOption, FreshOption, print_cached, store_in
from safeloc.cli.options import ConfigOption, DepthOption, JobsOption, SecondsOption, SeedOption, TargetArgument
from safeloc.cli.show import code
from safeloc.errors import InputError
from safeloc.explain.explanation import Explanation, Section, explained
from safeloc.explain.pytest_file import pytest_file
from safeloc.explain.recording import explained_recording
from safeloc.language.renamed import hint
from safeloc.language.spec import Property
from safeloc.language.verdict import Proved, word
from safeloc.proof.cache.store import Store
from safeloc.proof.cores.cores import Core
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding
from safeloc.proof.verification.calls import prove_target
from safeloc.target import find_recording

SCHEMA = "safeloc-explanation/1"


def explain(
    target: TargetArgument,
    name: Annotated[str, typer.Argument(metavar="PROPERTY", help="name of the property (safeloc list properties)")],
    stream: Annotated[
        Path | None,
        typer.Argument(
            help="explain it on this recording instead: a file, or the name of one that ships", show_default=False
        ),
    ] = None,
    config: ConfigOption = None,
    configuration: Annotated[
        str | None, typer.Option(help="a declared configuration of a shipped machine, by name, in place of --config")
    ] = None,
    depth: DepthOption = 25,
    seconds: SecondsOption = 30.0,
    jobs: JobsOption = 2,
    seed: SeedOption = 0,
    test: Annotated[
        Path | None, typer.Option("--pytest", help="write the run that violates it as a test file", dir_okay=False)
    ] = None,
    cache: CacheOption = None,
    fresh: FreshOption = False,
    as_json: Annotated[bool, typer.Option("--json", help=f"print JSON only (schema {SCHEMA})")] = False,
) -> None:
    """Explain one property: what it says and assumes, how it was decided, what that rests on, and the run that violates it."""
    loaded, limits, store = (
        _loaded(target, config, configuration),
        Limits(depth=depth, seconds=seconds, seed=seed),
        store_in(cache),
    )
    prop = _chosen(loaded, name)
    if stream is not None:
        told, finding = explained_recording(loaded, prop, find_recording(loaded, stream))
        raise typer.Exit(_show(told, finding, loaded, prop, config, test, as_json=as_json))
    findings = prove_target(loaded, only=[prop.name], limits=limits, jobs=jobs, store=store, fresh=fresh)
    print_cached(findings, quiet=as_json)
    [finding] = [one for one in findings if one.kind == "property"]
    open_ = [one for one in findings if one.kind == "obligation" and not isinstance(one.result, Proved)]
    find_core = partial(_core, loaded, limits, jobs, store, fresh)
    told = explained(loaded, prop, finding, limits, find_core=find_core, shown_by=_strengths(store, loaded, prop))
    _show(_warned(told, open_), finding, loaded, prop, config, test, as_json=as_json)
    raise typer.Exit(code([finding, *open_]))


def _warned(told: Explanation, open_: Sequence[Finding]) -> Explanation:
    """Put first that the assumption is not shown to be kept, where it is not: then the proof may be empty."""
    if not open_:
        return told
    lines = [f"{word(one.result)}: {one.statement}. {getattr(one.result, 'reason', '')}".rstrip() for one in open_]
    return replace(told, sections=(Section("The proof may be empty: its assumption", tuple(lines)), *told.sections))


def _loaded(target: str, config: Path | None, configuration: str | None) -> Target:
    if configuration is None:
        return load_target(target, config)
    if config is not None:
        raise typer.BadParameter("--config and --configuration exclude each other: give a file, or a declared name.")
    made = [loaded for _, loaded in configured(target, [configuration])]
    if len(made) != 1:
        raise typer.BadParameter("a property is explained in one configuration: give the name of one, not `all`.")
    return made[0]


def _show(
    told: Explanation,
    finding: Finding,
    target: Target,
    prop: Property,
    config: Path | None,
    test: Path | None,
    *,
    as_json: bool,
) -> int:
    """Print an explanation, write its run as a test if wanted, and return the exit code."""
    _print(told, finding, as_json=as_json)
    if test is not None:
        _write_test(test, target, prop, told, config)
    return code([finding])


def _core(target: Target, limits: Limits, jobs: int, store: Store, fresh: bool, prop: Property) -> Core:
    look_in = None if fresh else store
    [found] = cores_of(target, [prop], limits, jobs=jobs, on_core=lambda _: None, look_in=look_in, keep_in=store)
    return found


def _chosen(target: Target, name: str) -> Property:
    known = {prop.name: prop for prop in target.properties}
    if name not in known:
        listed = f"`safeloc list properties {target.spec or target.name}` lists them"
        raise typer.BadParameter(f"{target.name} has no property {name!r}; {listed}.{hint(name, known)}")
    return known[name]


def _strengths(store: Store, target: Target, prop: Property) -> Sequence[str]:
    known = kept_strengths(store, target)
    return [f"{requirement}: {known[requirement]}" for requirement in prop.requirements if requirement in known]


def _write_test(path: Path, target: Target, prop: Property, told: Explanation, config: Path | None) -> None:
    if told.run is None:
        err.print(f"no run that violates {prop.name!r} was found; {path} is not written.", markup=False)
        return
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(pytest_file(target, prop, told.run, config))
    except FileExistsError:
        raise InputError(f"{path} exists; give another file, since its content would be lost.") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}.") from error
    err.print(f"test: {path}", markup=False)


def _print(told: Explanation, finding: Finding, *, as_json: bool) -> None:
    if as_json:
        print(json.dumps(_data(told, finding), ensure_ascii=False, indent=1))
        return
    print_line(finding.id)
    for section in told.sections:
        out.print(f"\n{section.heading}", markup=False, style="bold")
        for line in section.lines:
            print_line(f"  {line}")


def _data(told: Explanation, finding: Finding) -> dict[str, Any]:
    run = told.run
    return {
        "schema": SCHEMA,
        "id": finding.id,
        "sections": [{"heading": one.heading, "lines": list(one.lines)} for one in told.sections],
        "run": None if run is None else {"first": dict(run.initial), "steps": run.stream()},
    }
