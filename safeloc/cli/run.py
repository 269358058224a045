"""`safeloc run`: a machine as a separate process that reads lines (MRK-3)."""

from __future__ import annotations

import selectors
from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Annotated

import typer

from safeloc.catalogue import load_target
from safeloc.cli.files import same_file
from safeloc.errors import InputError, SnapshotError
from safeloc.language.nodes import Value
from safeloc.models.sections import SectionsConfig
from safeloc.railway.trackside.area_fleet import AreaFleet, VehicleReports
from safeloc.railway.trackside.wiring import Wiring, load_wiring
from safeloc.runtime.embedding import Program
from safeloc.runtime.embedding.arguments import period_of
from safeloc.runtime.service.address import Address, address
from safeloc.runtime.service.broker.connection import load_paho
from safeloc.runtime.service.broker.division import Division
from safeloc.runtime.service.broker.epochs import require_layout
from safeloc.runtime.service.broker.settings import Broker, is_broker, read_broker
from safeloc.runtime.service.broker.topics import Topics
from safeloc.runtime.service.clock_lag import LONGEST_GAP_MS
from safeloc.runtime.service.feeds import Feed, GrowingFile, Stdin
from safeloc.runtime.service.fleet import Fleet, FleetSettings
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.loop import Loop, exit_code
from safeloc.runtime.service.messages import VEHICLE
from safeloc.runtime.service.metrics import Metrics, load_prometheus
from safeloc.runtime.service.outlets import Outlet, Stdout, ToFile
from safeloc.runtime.service.saving import Saver, claimed, read_saved
from safeloc.runtime.service.station import Parts, Station, Work
from safeloc.runtime.service.supervised import Supervised
from safeloc.runtime.service.tcp import TcpPort
from safeloc.runtime.service.tracing import Tracer
from safeloc.runtime.service.udp import UdpPort
from safeloc.runtime.service.watchdog import Watchdog
from safeloc.runtime.service.workers import Link, Workers
from safeloc.runtime.streams.gzipped import is_packed

_STDOUT, STDERR = 1, 2
_VEHICLES_PER_PEER = 250
_BACK = "back"
_MOST_PROCESSES, _LAST_PORT = 64, 65_535


def run(
    target: Annotated[str, typer.Argument(help="a name from `safeloc list`, or package.module:name, or file.py:name")],
    config: Annotated[
        Path | None, typer.Option("--config", help="TOML or JSON with the machine's configuration")
    ] = None,
    source: Annotated[
        str,
        typer.Option(
            "--from",
            help="stdin, file:PATH (may grow), tcp:, udp: or proxy:PORT (on this machine), mqtts://HOST/PREFIX",
        ),
    ] = "stdin",
    sink: Annotated[
        str | None, typer.Option("--to", help="stdout, file:PATH, or back (over the socket; the default there)")
    ] = None,
    inputs: Annotated[
        bool, typer.Option("--inputs", help="each line holds the inputs of one step instead of a record")
    ] = False,
    period_ms: Annotated[
        int | None, typer.Option("--period-ms", help="length of a cycle, if the configuration has none", min=1)
    ] = None,
    expect: Annotated[
        list[str] | None, typer.Option("--expect", help="CHANNEL=N: the channel sends N records per cycle (repeatable)")
    ] = None,
    first: Annotated[
        list[str] | None, typer.Option("--first", help="NAME=VALUE: first value of an open variable (repeatable)")
    ] = None,
    snapshot: Annotated[
        Path | None,
        typer.Option("--snapshot", help="file to save snapshots in, and to resume from; a folder with a broker"),
    ] = None,
    every_ms: Annotated[int, typer.Option("--snapshot-every-ms", help="least time between snapshots", min=10)] = 1_000,
    fresh: Annotated[bool, typer.Option("--fresh", help="start from the initial state; ignore the snapshot")] = False,
    broker_file: Annotated[
        Path | None,
        typer.Option("--broker", help="TOML with partitions, lease_ms, user, password_file, authority_file, ..."),
    ] = None,
    trackside: Annotated[
        Path | None,
        typer.Option("--trackside", help="TOML with areas of `sections`, fed by the vehicles' reports on the broker"),
    ] = None,
    processes: Annotated[
        int | None,
        typer.Option(
            "--processes",
            help="with a broker: prepare the machine once, fork so many workers, and start each again that ends",
            min=1,
            max=_MOST_PROCESSES,
        ),
    ] = None,
    watchdog_ms: Annotated[
        int | None,
        typer.Option("--watchdog-ms", help="end a cycle that is overdue by this much wall-clock time", min=1),
    ] = None,
    vehicles: Annotated[
        list[str] | None, typer.Option("--vehicle", help="ID=FILE: this vehicle's own configuration (repeatable)")
    ] = None,
    gap_ms: Annotated[
        int,
        typer.Option(
            "--longest-gap-ms",
            help="longest gap bridged by widening the interval; after a longer one the vehicle restarts",
            min=1,
        ),
    ] = LONGEST_GAP_MS,
    of_a_peer: Annotated[
        int,
        typer.Option(
            "--vehicles-per-peer",
            help="largest number of vehicles for which one peer may send, over tcp and udp",
            min=1,
        ),
    ] = _VEHICLES_PER_PEER,
    alive: Annotated[
        Path | None, typer.Option("--alive", help="file to touch every second while the process is healthy")
    ] = None,
    metrics_port: Annotated[
        str | None, typer.Option("--metrics", help="port on this machine for the figures of the process (Prometheus)")
    ] = None,
    log_cycles: Annotated[
        bool, typer.Option("--log-cycles", help="log each cycle with its id, its lines and the time until its report")
    ] = False,
    assumptions: Annotated[
        bool,
        typer.Option(
            "--assumptions/--no-assumptions",
            help="check the proofs' assumptions in each cycle, as far as inputs show them; report breaches",
        ),
    ] = True,
    to_its_end: Annotated[
        bool, typer.Option("--until-end", help="stop at the end of the file; do not wait for more lines")
    ] = False,
) -> None:
    """Run a machine as a separate process: read lines, write one report per cycle, until SIGTERM or the end of the
    input."""
    _require_apart(source, sink, snapshot, alive)
    program = Program(load_target(target, config))
    period = period_of(program, period_ms)
    wiring = None if trackside is None else _wiring(trackside, program, source, first, vehicles)
    broker = _broker(source, broker_file, wiring)
    most = of_a_peer if source.startswith(("tcp:", "udp:", "proxy:")) else None
    settings = FleetSettings(
        period, inputs, source.startswith("udp:") or is_broker(source), gap_ms, most_of_a_peer=most,
        expected=_expected(expect), first=_first(first), assumptions=assumptions,
    )  # fmt: skip
    journal, programs = Journal(STDERR), _programs(target, vehicles)
    selector = _selector()

    def new_fleet() -> Fleet:
        if wiring is None or broker is None or broker.codes is None:
            return Fleet(program, settings, programs)
        return AreaFleet(program, settings, wiring, broker.codes, Topics(broker.prefix, broker.partitions))

    supervised = Supervised(alive)
    link: Link | None = None
    if broker is not None:
        _require_usable(sink, snapshot, fresh=fresh, to_its_end=to_its_end)
    metrics_at = None if metrics_port is None else address(metrics_port)
    if processes is not None:
        link = _forked(processes, broker, snapshot, new_fleet, Workers(processes, journal, supervised), metrics_at)
        journal, supervised = Journal(STDERR, worker=link.number), Supervised(None, {}, link.tell)
        metrics_at = None if metrics_at is None else _port_of(metrics_at, link.number)
    metrics = None if metrics_at is None else Metrics(metrics_at)
    tracer = _tracer(journal, metrics, log_cycles=log_cycles)

    def parts_of(feed: Feed, outlet: Outlet, saver: Saver | None) -> Parts:
        watchdog = None if watchdog_ms is None else Watchdog((period + watchdog_ms) / 1_000, period / 1_000)
        return Parts(feed, outlet, new_fleet(), journal, saver, every_ms / 1_000, watchdog, tracer)

    if broker is not None:
        assert snapshot is not None
        work: Work = Division(
            broker, snapshot, program.name, lambda port, path: Station(parts_of(port, port, Saver(path))), journal,
            None if wiring is None else VehicleReports(wiring, broker.partitions), None if link is None else link.name,
        )  # fmt: skip
        Loop(work, selector, journal, supervised, metrics, None if link is None else link.sock).run()
    else:
        feed = _feed(source, journal, to_its_end=to_its_end)
        parts = parts_of(feed, _outlet(sink, feed, selector), None)
        with claimed(snapshot):
            work = Station(parts) if snapshot is None else _resumed(snapshot, parts, fresh=fresh)
            Loop(work, selector, journal, supervised, metrics).run()
    raise typer.Exit(exit_code(work))


def _selector() -> selectors.BaseSelector:
    """Return a selector of the only kind that accepts a file as standard input."""
    made: selectors.BaseSelector = getattr(selectors, "PollSelector", selectors.SelectSelector)()
    return made


def _tracer(journal: Journal, metrics: Metrics | None, *, log_cycles: bool) -> Tracer | None:
    """Return what follows each cycle for the log and the figures, if any of them is wanted; log where the figures are."""
    if metrics is not None:
        journal.info("metrics", port=metrics.port)
    if metrics is None and not log_cycles:
        return None
    return Tracer(journal if log_cycles else None, None if metrics is None else metrics.observe)


def _forked(
    processes: int, broker: Broker | None, snapshot: Path | None, new_fleet: Callable[[], Fleet], workers: Workers,
    metrics_at: Address | None,
) -> Link:  # fmt: skip
    """Prepare what all workers need, then fork them; return in a worker only. The parent ends when all have ended."""
    if broker is None or snapshot is None:
        raise typer.BadParameter("--processes is for --from mqtt://... or mqtts://...: a broker divides the vehicles.")
    if broker.partitions < processes:
        raise typer.BadParameter(f"--processes {processes}: more than the {broker.partitions} partitions of the fleet.")
    if metrics_at is not None:
        _port_of(metrics_at, processes - 1)
        load_prometheus()
    require_layout(snapshot, broker.partitions)
    load_paho()
    new_fleet().make_ready_to_save()
    ended = workers.run()
    if isinstance(ended, int):
        raise typer.Exit(ended)
    return ended


def _port_of(first: Address, number: int) -> Address:
    """Return the address of a worker's figures: the port that was given, plus its number; 0 stays any port."""
    port = first.port + number if first.port else 0
    if port > _LAST_PORT:
        raise typer.BadParameter(f"--metrics {first.port}: worker {number} would have port {port}; give a lower one.")
    return replace(first, port=port)


def _wiring(path: Path, program: Program, source: str, first: list[str] | None, vehicles: list[str] | None) -> Wiring:
    """Read the areas; refuse what does not go with them."""
    if not is_broker(source):
        raise typer.BadParameter(
            "--trackside is for --from mqtts://HOST/PREFIX: reports of vehicles come over a broker."
        )
    if first or vehicles:
        raise typer.BadParameter("--first and --vehicle are not for areas: the file of --trackside says what each has.")
    config = program.target.config
    if program.name != "sections" or not isinstance(config, SectionsConfig):
        raise typer.BadParameter(f"--trackside is for the machine sections, not for {program.name}.")
    return load_wiring(path, config)


def _broker(source: str, path: Path | None, wiring: Wiring | None) -> Broker | None:
    """Return the broker of `--from`; None if it names none."""
    if not is_broker(source):
        if path is not None:
            raise typer.BadParameter("--broker is for --from mqtt://... or mqtts://...")
        return None
    if path is not None and not path.is_file():
        raise InputError(f"{path}: no such file.")
    broker = read_broker(source, path)
    if wiring is not None and broker.codes is None:
        raise typer.BadParameter(
            "--trackside needs code_key_file in the file of --broker, the same as the fleet's: only a code shows that a report "
            "is unchanged."
        )
    if wiring is not None and wiring.file.fleet == broker.prefix:
        raise wiring.refuse(("fleet",), f"{broker.prefix} is the prefix of the areas; the fleet needs one of its own.")
    return broker


def _require_usable(sink: str | None, snapshot: Path | None, *, fresh: bool, to_its_end: bool) -> None:
    """Refuse options that mean nothing with a broker."""
    if sink not in (None, _BACK):
        raise typer.BadParameter(f"--to {sink!r}: with a broker, reports go back to it.")
    if snapshot is None:
        raise typer.BadParameter(
            "--snapshot FOLDER is needed with a broker: records are acknowledged when they are saved."
        )
    if snapshot.exists() and not snapshot.is_dir():
        raise InputError(f"{snapshot}: no folder; with a broker each partition has its own snapshot in a folder.")
    if fresh:
        raise typer.BadParameter("--fresh is not for a broker: stop all processes and give them a new folder.")
    if to_its_end:
        raise typer.BadParameter("--until-end is for --from file:PATH.")


def _require_apart(source: str, sink: str | None, snapshot: Path | None, alive: Path | None) -> None:
    """Raise InputError if one file has two roles among input, output, snapshot and sign of life."""
    kinds = {"--from": source, "--to": sink or ""}
    kinds |= {name: f"file:{path}" for name, path in (("--snapshot", snapshot), ("--alive", alive)) if path is not None}
    files = {option: Path(name[5:]) for option, name in kinds.items() if name.startswith("file:") and name[5:]}
    for (one, file), (other, same) in combinations(files.items(), 2):
        if same_file(file, same):
            raise InputError(f"{file}: given for {one} and for {other}; give each its own file.")


def _resumed(snapshot: Path, parts: Parts, *, fresh: bool) -> Station:
    """Return the station, in the state of the snapshot if there is one and `fresh` does not ignore it."""
    saved = None if fresh else read_saved(snapshot)
    station = Station(replace(parts, saver=Saver(snapshot)))
    if saved is not None:
        try:
            station.restore(saved)
        except SnapshotError as error:
            raise SnapshotError(f"{snapshot}: {error} To start from the initial state: --fresh.") from error
    return station


def _feed(source: str, journal: Journal, *, to_its_end: bool) -> Feed:
    kind, _, where = source.partition(":")
    if to_its_end and kind != "file":
        raise typer.BadParameter("--until-end is for --from file:PATH.")
    match kind, where:
        case "stdin", "":
            return Stdin()
        case "file", where if where:
            return GrowingFile(_plain(Path(where)), to_its_end=to_its_end)
        case "tcp", where if where:
            return TcpPort(address(where), journal)
        case "udp", where if where:
            return UdpPort(address(where), journal)
        case "proxy", where if where:
            return TcpPort(address(where), journal, proxied=True)
        case _:
            raise typer.BadParameter(
                f"--from {source!r}: choose stdin, file:PATH, tcp:PORT, udp:PORT, proxy:PORT or mqtts://HOST/PREFIX."
            )


def _plain(path: Path) -> Path:
    """Return the path; InputError for a compressed stream, which cannot grow and has no lines to follow."""
    if is_packed(path):
        raise InputError(
            f"{path}: a compressed file cannot be followed line by line; unpack it: gzip -dc {path} | safeloc run ..."
        )
    return path


def _outlet(sink: str | None, feed: Feed, selector: selectors.BaseSelector) -> Outlet:
    if sink is None:
        sink = _BACK if isinstance(feed, Outlet) else "stdout"
    kind, _, where = sink.partition(":")
    match kind, where:
        case "stdout", "":
            return Stdout(selector, _STDOUT)
        case "file", where if where:
            return ToFile(Path(where))
        case "back", "" if isinstance(feed, Outlet):
            return feed
        case _:
            raise typer.BadParameter(
                f"--to {sink!r}: choose stdout, file:PATH, or back where lines come over a socket."
            )


def _programs(target: str, given: list[str] | None) -> Mapping[str, Program]:
    """Return the program of each vehicle that has its own configuration (--vehicle)."""
    programs = {}
    for one in given or ():
        name, _, file = one.partition("=")
        if not VEHICLE.fullmatch(name) or not file:
            raise InputError(f"--vehicle {one!r}: give ID=FILE, for instance 12=freight.toml.")
        programs[name] = Program(load_target(target, Path(file)))
    return programs


def _expected(given: list[str] | None) -> Mapping[str, int]:
    expected = {}
    for one in given or ():
        channel, _, count = one.partition("=")
        if not channel or not (count.isascii() and count.isdecimal()):
            raise InputError(f"--expect {one!r}: give CHANNEL=N, for instance front_wheel=1.")
        expected[channel] = int(count)
    return expected


def _first(given: list[str] | None) -> Mapping[str, Value]:
    values: dict[str, Value] = {}
    for one in given or ():
        name, _, value = one.partition("=")
        truths = {"true": True, "false": False}
        try:
            values[name] = truths[value] if value in truths else int(value)
        except ValueError as error:
            raise InputError(f"--first {one!r}: give NAME=VALUE, a whole number, true or false.") from error
    return values
