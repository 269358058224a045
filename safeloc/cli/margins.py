"""`safeloc margins`: how far each figure may move before a claim fails."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, cast, get_args

import typer

from safeloc.assurance.margins.asking import Where, chosen_claims
from safeloc.assurance.margins.figures import Figure, chosen_figures
from safeloc.assurance.margins.kept_margins import keep_margins
from safeloc.assurance.margins.limits_of_figures import Limit
from safeloc.assurance.margins.margin_data import SCHEMA, in_words, margins_data, row
from safeloc.assurance.margins.margin_work import Margins
from safeloc.catalogue import ENTRIES, Target, load_target
from safeloc.cli.console import err, out, print_json
from safeloc.cli.fronts import check_pairs, declared_pairs, found_fronts, given_pairs, print_front
from safeloc.cli.keeping import CacheOption, FreshOption, store_in
from safeloc.cli.line_design import DesignOptions, design_line
from safeloc.cli.options import ConfigOption, JobsOption, TargetArgument
from safeloc.cli.show import EXIT_CODES, Progressing
from safeloc.errors import InputError
from safeloc.proof.cache.answers import kept_in
from safeloc.proof.provers.limits import Limits
from safeloc.railway.map.toml_files import shipped_lines
from safeloc.report.file_names import file_names
from safeloc.report.margins import alone, front_picture, margins_picture
from safeloc.target import Pair

_SECONDS = 10.0


def margins(
    target: TargetArgument,
    config: ConfigOption = None,
    figure: Annotated[list[str] | None, typer.Option(help="only this figure of the configuration (repeatable)")] = None,
    only: Annotated[
        list[str] | None, typer.Option("--property", help="only this claim has to hold (repeatable)")
    ] = None,
    where: Annotated[
        str,
        typer.Option(
            help="world: the figure moves in the world, the machine keeps its configuration; "
            "design: it moves in machine, world and claims alike"
        ),
    ] = "world",
    pair: Annotated[
        list[str] | None,
        typer.Option(
            help="two figures with their directions, as FIGURE:up,FIGURE:down: the front of both (repeatable)"
        ),
    ] = None,
    pairs: Annotated[
        bool, typer.Option("--pairs", help="the fronts of the pairs that are declared with the machine")
    ] = False,
    folder: Annotated[
        Path | None, typer.Option("--out", help="folder for pictures of limits and fronts", file_okay=False)
    ] = None,
    tolerance: Annotated[
        str | None,
        typer.Option(
            "--for",
            help="TARGET is a line, by name or file: which balise groups, reflectors and markers keep this tolerance at least cost, "
            "such as tolerance=30m",
        ),
    ] = None,
    vehicle: Annotated[str | None, typer.Option(help="with --for: the vehicle, as for `safeloc audit`")] = None,
    cost: Annotated[
        list[str] | None, typer.Option(help="with --for: a cost, such as add_group_eur=12000 (repeatable)")
    ] = None,
    add: Annotated[
        list[str] | None,
        typer.Option(help="with --for: a figure of what is added, such as location_accuracy_mm=300 (repeatable)"),
    ] = None,
    keep: Annotated[
        list[str] | None,
        typer.Option(
            help="with --for: a balise group, reflector or marker that stays, by its id or as markers=ID (repeatable)"
        ),
    ] = None,
    seconds: Annotated[
        float, typer.Option(help="limit for each claim at each value, as solvers count", min=0.1)
    ] = _SECONDS,
    jobs: JobsOption = 2,
    cache: CacheOption = None,
    fresh: FreshOption = False,
    as_json: Annotated[bool, typer.Option("--json", help=f"print JSON only (schema {SCHEMA})")] = False,
) -> None:
    """Find how far each figure may move before a claim fails: the last value with a proof, and the next one with a run.

    Exit code 0: every limit was found; 2: a claim is not proved with the figures as they are; 3: some value is undecided within
    the limits.
    """
    for_line = DesignOptions(vehicle, cost or (), add or (), keep or (), folder, seconds, as_json)
    if tolerance is not None:
        design_line(target, tolerance, for_line)
        return
    if for_line.named():
        raise typer.BadParameter(f"{for_line.named()[0]} is for the design of a line; give --for too.")
    if where not in get_args(Where):
        raise typer.BadParameter(f"--where is world or design, not {where!r}.")
    if target not in ENTRIES and target in shipped_lines():
        raise InputError(f"{target} is a line; say for which tolerance to design it, such as --for tolerance=30m.")
    loaded = load_target(target, config)
    figures, store = chosen_figures(loaded, figure), store_in(cache)
    asked, look_in = chosen_claims(loaded, only), None if fresh else store
    wanted = [*(declared_pairs(loaded) if pairs else []), *given_pairs(pair or (), where)]
    if wanted and figure:
        raise typer.BadParameter(
            "--figure asks for the limits of single figures; leave it out beside --pair and --pairs."
        )
    check_pairs(loaded, wanted)
    work = Margins(loaded, cast(Where, where), asked, Limits(seconds=seconds), jobs, look_in, store)
    with kept_in(store, fresh=fresh):
        _refuse_if_one_fails(work, quiet=as_json)
        if wanted:
            _fronts(work, wanted, folder, keep=pairs and only is None, as_json=as_json)
            return
        if figure is None:
            _say_what_it_takes(loaded, figures, work.claims)
        limits = _found(work, figures, quiet=as_json)
    if figure is None and only is None:
        keep_margins(store, loaded, work.where, [row(one) for one in limits])
    if folder is not None:
        _write(folder, {f"margins-{where}": margins_picture([row(one) for one in limits], where)})
    if as_json:
        print_json(margins_data(work, limits))
    else:
        for line in _lines(limits):
            out.print(line, markup=False, soft_wrap=True)
    if any(one.end.end == "undecided" for one in limits):
        raise typer.Exit(EXIT_CODES["unknown"])


def _fronts(work: Margins, pairs: Sequence[Pair], folder: Path | None, *, keep: bool, as_json: bool) -> None:
    """Search the fronts, print them, write their pictures, and keep those of declared pairs for reports."""
    found = found_fronts(work, pairs, quiet=as_json)
    if keep and work.keep_in is not None:
        declared = {one.name for one in declared_pairs(work.target)}
        keep_margins(work.keep_in, work.target, "pairs", [one for one in found if one["name"] in declared])
    if folder is not None:
        names = file_names([one["name"] for one in found])
        _write(folder, {f"front-{names[one['name']]}": front_picture(one) for one in found})
    if as_json:
        print_json({"schema": SCHEMA, "target": work.target.name, "fronts": found})
        return
    for one in found:
        print_front(one)


def _write(folder: Path, pictures: Mapping[str, str]) -> None:
    """Write pictures as SVG files; one without anything to draw is left out."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, drawn in pictures.items():
            if drawn:
                path = folder / f"{name}.svg"
                path.write_text(alone(drawn), encoding="utf-8")
                err.print(str(path), markup=False)
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error}") from error


def _refuse_if_one_fails(work: Margins, *, quiet: bool) -> None:
    """Prove all claims with the figures as they are; InputError if one is not proved."""
    with Progressing(len(work.claims), quiet=quiet) as progress:
        progress.say(f"{work.target.name} as it is", len(work.claims))
        for claim, verdict in work.as_it_is():
            progress.tick(f"{verdict:8} {claim}")
            if verdict != "proved":
                raise InputError(
                    f"there is no margin to find: {claim!r} is {verdict} with the figures as they are (`safeloc prove`); "
                    "give the claims that have to hold with --property."
                )


def _say_what_it_takes(target: Target, figures: Sequence[Figure], claims: Sequence[str]) -> None:
    """Say of a composition how many questions its limits are, and which machines answer most of them alone."""
    entry = ENTRIES.get(target.spec)
    if not target.system.parts or entry is None:
        return
    alone = ", ".join(f"`safeloc margins {name}`" for name in entry.pairs_of)
    err.print(
        f"{target.name} is a composition: {2 * len(figures)} directions, and each asks up to {len(claims)} claims of the whole at every value. "
        + (f"Each law stands in the world of one machine: {alone} take minutes. " if alone else "")
        + "Or name figures with --figure.",
        markup=False,
        soft_wrap=True,
    )


def _found(work: Margins, figures: Sequence[Figure], *, quiet: bool) -> list[Limit]:
    with Progressing(2 * len(figures), quiet=quiet) as progress:
        progress.say(f"limits of {work.target.name}", 2 * len(figures))
        found = list[Limit]()
        for one in work.singles(figures):
            progress.tick(f"{one.figure.name} {one.direction}: {one.holds_to}")
            found.append(one)
    order = {one.name: number for number, one in enumerate(figures)}
    return sorted(found, key=lambda one: (order[one.figure.name], one.direction == "up"))


def _lines(limits: Sequence[Limit]) -> Iterator[str]:
    last = ""
    for one in limits:
        if one.figure.name != last:
            yield f"{one.figure.name} = {one.figure.value} {one.figure.unit}".rstrip()
            last = one.figure.name
        to = (
            f"to {one.holds_to} ({one.margin} {one.figure.unit})".replace(" )", ")")
            if one.margin
            else "no margin"
            if one.end.end in ("broken", "undecided")
            else "stays"
        )
        yield f"    {one.direction:5} {to}; {in_words(one)}"
