"""`safeloc margins`: how far each figure may move before a claim fails."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Annotated, cast, get_args

import typer

from safeloc.assurance.margins.asking import Where, chosen_claims
from safeloc.assurance.margins.figures import Figure, chosen_figures
from safeloc.assurance.margins.kept_margins import keep_margins
from safeloc.assurance.margins.limits_of_figures import Direction, Limit
from safeloc.assurance.margins.margin_data import SCHEMA, in_words, margins_data, row
from safeloc.assurance.margins.margin_work import Margins, front
from safeloc.catalogue import load_target
from safeloc.cli.console import out, print_json
from safeloc.cli.keeping import CacheOption, FreshOption, store_in
from safeloc.cli.options import ConfigOption, JobsOption, TargetArgument
from safeloc.cli.show import EXIT_CODES, Progressing
from safeloc.errors import InputError
from safeloc.proof.provers.limits import Limits

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
    if where not in get_args(Where):
        raise typer.BadParameter(f"--where is world or design, not {where!r}.")
    loaded = load_target(target, config)
    figures, store = chosen_figures(loaded, figure), store_in(cache)
    asked, look_in = chosen_claims(loaded, only), None if fresh else store
    work = Margins(loaded, cast(Where, where), asked, Limits(seconds=seconds), jobs, look_in, store)
    _refuse_if_one_fails(work, quiet=as_json)
    if pair:
        _fronts(work, pair, as_json=as_json)
        return
    limits = _found(work, figures, quiet=as_json)
    if figure is None and only is None:
        keep_margins(store, loaded, work.where, [row(one) for one in limits])
    if as_json:
        print_json(margins_data(work, limits))
    else:
        for line in _lines(limits):
            out.print(line, markup=False, soft_wrap=True)
    if any(one.end.end == "undecided" for one in limits):
        raise typer.Exit(EXIT_CODES["unknown"])


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
            "no margin" if one.margin == 0 else f"to {one.holds_to} ({one.margin} {one.figure.unit})".replace(" )", ")")
        )
        yield f"    {one.direction:5} {to}; {in_words(one)}"


def _fronts(work: Margins, pairs: Sequence[str], *, as_json: bool) -> None:
    every = {one.name: one for one in chosen_figures(work.target, None)}
    data = []
    for pair in pairs:
        (first, way), (second, other) = _of_pair(pair, every)
        points = list(front(work, first, way, second, other))
        data.append({"pair": pair, "points": [[value, one.holds_to, in_words(one)] for value, one in points]})
        if not as_json:
            out.print(f"{first.name} {way}, {second.name} {other}", markup=False)
            for value, one in points:
                out.print(f"    {value:>12} {one.holds_to:>12}  {in_words(one)}", markup=False, soft_wrap=True)
    if as_json:
        print_json({"schema": SCHEMA, "target": work.target.name, "where": work.where, "fronts": data})


def _of_pair(pair: str, every: dict[str, Figure]) -> tuple[tuple[Figure, Direction], tuple[Figure, Direction]]:
    named = []
    for part in pair.split(","):
        name, _, way = part.strip().partition(":")
        if name not in every or way not in get_args(Direction):
            raise typer.BadParameter(
                f"--pair takes two of {', '.join(every)}, each with :up or :down and joined by a comma; got {part!r}."
            )
        named.append((every[name], cast(Direction, way)))
    if len(named) != 2:
        raise typer.BadParameter(f"--pair takes two figures joined by a comma, got {len(named)}: {pair!r}.")
    return named[0], named[1]
