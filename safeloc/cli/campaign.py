"""`safeloc campaign`: many simulated vehicles, and what can be said of them."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from safeloc.cli.console import err, out, print_json
from safeloc.errors import InputError

if TYPE_CHECKING:
    from safeloc.campaign.declaration import Campaign
    from safeloc.campaign.schedule import Progress

_EVERY_S = 10.0
_INTERRUPTED = 130


def campaign(
    file: Annotated[Path, typer.Argument(help="the declaration (TOML, docs/campaigns.md)")],
    folder: Annotated[Path, typer.Option("--out", help="folder for shards, results and page")],
    resume: Annotated[bool, typer.Option("--resume", help="go on in a folder that holds shards already")] = False,
    discard: Annotated[
        bool, typer.Option("--discard", help="with --resume: delete shards that are not of this campaign as it is now")
    ] = False,
    workers: Annotated[int | None, typer.Option(help="local worker processes; else one for each core", min=1)] = None,
    in_process: Annotated[
        bool, typer.Option("--in-process", help="run the shards in this process, without Dask")
    ] = False,
    scheduler: Annotated[str | None, typer.Option(help="address of a Dask scheduler, as tcp://HOST:PORT")] = None,
    shard: Annotated[int | None, typer.Option(help="run this shard alone, and write its file", min=0)] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON only (schema safeloc-campaign/1)")] = False,
) -> None:
    """Run many simulated vehicles drawn from declared distributions; estimate how often what happens, each figure with its interval.

    Exit code 0: no wrong interval while every law was kept; 1: there was one.
    """
    if (in_process or workers is not None) + (scheduler is not None) + (in_process and workers is not None) > 1:
        raise typer.BadParameter("--in-process, --workers and --scheduler exclude each other.")
    try:
        from safeloc.campaign import schedule
        from safeloc.campaign.declaration import load_campaign
        from safeloc.campaign.scenes import check_strata
    except ImportError as error:
        raise InputError(f"campaigns need {error.name}: install safeloc[campaign].") from error
    declared = load_campaign(file)
    check_strata(declared)
    if shard is not None:
        _one(declared, shard, folder)
        return
    if not resume and any((folder / "shards").glob("*.parquet")):
        raise InputError(f"{folder}: holds shards already; go on with --resume, or give another folder.")
    where = schedule.Where(workers or schedule.CORES, in_process, scheduler)
    data = _all(declared, folder, where, discard=discard, quiet=as_json)
    if as_json:
        print_json(data)
    else:
        for line in _lines(data):
            out.print(line, markup=False)
        err.print(f"page: {folder / 'index.html'}", markup=False)
    if any(one["law"] == "law kept" and one["interval"] == "wrong interval" and one["cycles"] for one in data["laws"]):
        raise typer.Exit(1)


def _one(declared: Campaign, number: int, folder: Path) -> None:
    from safeloc.campaign.shards import digests, run_shard, write_shard

    known = digests(declared)
    if number not in known:
        raise InputError(f"--shard {number}: {declared.name} has the shards {min(known)} to {max(known)}.")
    path = write_shard(folder, number, known[number], run_shard(declared.text, declared.name, number))
    out.print(str(path), markup=False)


def _all(declared: Campaign, folder: Path, where: Any, *, discard: bool, quiet: bool) -> dict[str, Any]:
    from safeloc.campaign.results_folder import write_results
    from safeloc.campaign.schedule import run_missing

    telling = _Telling(quiet=quiet)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        run_missing(declared, folder, where, telling, discard=discard)
        return write_results(declared, folder)
    except KeyboardInterrupt as error:
        done = len(list((folder / "shards").glob("*.parquet")))
        err.print(f"interrupted: {done} shards are kept in {folder}; go on with --resume.", markup=False)
        raise typer.Exit(_INTERRUPTED) from error
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error}") from error
    finally:
        telling.end()


class _Telling:
    """Tells how far a campaign is: one line that is written over on a terminal, a line now and then in a pipe."""

    def __init__(self, *, quiet: bool) -> None:
        self._quiet, self._last = quiet, 0.0
        self._status = None if quiet or not err.is_terminal else err.status("")
        if self._status is not None:
            self._status.start()

    def __call__(self, progress: Progress) -> None:
        if self._status is not None:
            self._status.update(_words(progress))
        elif not self._quiet and (time.monotonic() - self._last > _EVERY_S or progress.done == progress.shards):
            self._last = time.monotonic()
            err.print(_words(progress), markup=False)

    def end(self) -> None:
        """End the line."""
        if self._status is not None:
            self._status.stop()


def _words(one: Progress) -> str:
    left = "" if one.seconds_left is None else f", about {one.seconds_left:.0f} s left"
    damaged = f", {one.damaged} damaged ones are run again" if one.damaged else ""
    counts = f"{one.kept_wrong} with a wrong interval and every law kept, {one.broken_wrong} after a broken law"
    return f"{one.done} of {one.shards} shards{damaged}; {one.cycles:,} vehicle-cycles run, {counts}{left}"


def _lines(data: Mapping[str, Any]) -> Iterator[str]:
    from safeloc.report.campaign_page import share_words

    at = f"{100 * data['confidence']:g} %"
    yield f"{data['machine']}: {data['vehicle_cycles']:,} vehicle-cycles; every interval at {at}"
    yield "vehicle-cycles, and their share of a vehicle's cycles in operation"
    for one in data["laws"]:
        yield f"    {one['law']:10} {one['interval']:16} {one['cycles']:>16,}  {share_words(one['whole'])}"
    for question, answers in data["answers"].items():
        yield question
        for one in answers:
            yield f"    {one['what']}"
            yield from (f"        {line}" for line in _answer(one, data))
    broken = [one for one in data["clauses"] if one["cycles"]]
    yield f"clauses broken: {len(broken)} of {len(data['clauses'])}"
    for one in broken:
        yield f"    {one['name']}: {one['cycles']:,} cycles, share of vehicles {share_words(one['whole'])}"
    for one in data["found"]:
        yield f"{one['why']}: {one['vehicles']:,} vehicles, {one['kept']} kept as streams"
    for one in data["streams"]:
        yield f"{one['why']}: {one['command']}"


def _answer(one: Mapping[str, Any], data: Mapping[str, Any]) -> Iterator[str]:
    from safeloc.report.campaign_page import share_words

    for number, (stratum, part) in enumerate(zip(data["strata"], one["strata"], strict=True)):
        if "quantiles" in part:
            shares = [_quantile(each, one["unit"]) for each in part["quantiles"]]
            withdrawn = (one.get("withdrawn") or [None] * len(data["strata"]))[number]
            also = f"; within the run {share_words(withdrawn)} of the vehicles" if withdrawn else ""
            yield f"{stratum['name']}: {part['trials']} vehicles{'; ' if shares else ''}{'; '.join(shares)}{also}"
        else:
            says = f"; {part['says']}" if "says" in part else ""
            yield f"{stratum['name']}: {share_words(part)}{says}"
    if "whole" in one:
        yield f"in operation: {share_words(one['whole'])}"


def _quantile(one: Mapping[str, Any], unit: str) -> str:
    value, low, high = (one[name] for name in ("value", "low", "high"))
    said = "not within the run" if value is None else f"{value} {unit}"
    bounds = "" if low is None else f" ({low} to {'beyond' if high is None else high})"
    return f"{100 * one['share']:g} % {said}{bounds}"
