"""`safeloc prove TARGET --around STREAM`: a proof over all streams near a given one."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from safeloc.catalogue import ENTRIES, load_target
from safeloc.cli.console import err
from safeloc.cli.show import result
from safeloc.errors import InputError
from safeloc.language.expr import Num
from safeloc.language.first_values import ANY
from safeloc.language.renamed import hint
from safeloc.language.spec import Property
from safeloc.language.verdict import Proved, Violated
from safeloc.proof.around.bands import Bands, recorded_series
from safeloc.proof.around.claims import Asked, signals, written_claim
from safeloc.proof.around.deviations import deviations
from safeloc.proof.around.given import Recorded, recorded
from safeloc.proof.around.proving import Around, General
from safeloc.proof.cache.store import Store
from safeloc.proof.cores.clauses import ClauseId, assumed_clauses, without
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding
from safeloc.proof.verification.calls import chosen_properties, prove_target
from safeloc.proof.verification.replay import read_recording
from safeloc.report.around import deviation_picture, tube_picture
from safeloc.report.file_names import file_names
from safeloc.runtime.streams.steps import StepStream, write_steps
from safeloc.target import Target, find_recording, recording_name


@dataclass(frozen=True)
class AroundOptions:
    """The options of a proof around a stream, as they are given."""

    stream: str | None = None
    simulate: str | None = None
    within: Sequence[str] = ()
    drop: Sequence[str] = ()
    delay: Sequence[str] = ()
    claims: Sequence[str] = ()
    first: int | None = None
    last: int | None = None
    without: Sequence[str] = ()
    out: Path | None = None

    def named(self) -> list[str]:
        """Return the options that were given besides the stream."""
        given = {
            "--within": self.within,
            "--drop": self.drop,
            "--delay": self.delay,
            "--claim": self.claims,
            "--from": self.first,
            "--until": self.last,
            "--without": self.without,
            "--out": self.out,
        }
        return [name for name, value in given.items() if value]


@dataclass(frozen=True)
class Proving:
    """The options that a proof around a stream shares with any other proof."""

    config: Path | None
    only: list[str] | None
    limits: Limits
    store: Store
    quiet: bool


def prove_around(target: str, options: AroundOptions, proving: Proving) -> int:
    """Prove what is asked around a stream, print it, write pictures and streams; return the exit code."""
    loaded, stream, name = _stream(target, options, proving.config)
    run = recorded(loaded, Path(name), stream)
    system = without(loaded.system, _laws(loaded, options.without)) if options.without else loaded.system
    near = deviations(
        loaded.system,
        _figures("--within", options.within),
        _figures("--drop", options.drop),
        _figures("--delay", options.delay),
    )
    _require_truth(loaded, run, list(near.widths), name)
    asked = _asked(loaded, options, proving.only, run.given.length)
    bands = Bands(loaded.system, _drawn(loaded, asked, list(near.widths)))
    around = Around(
        loaded.name, system, name, run.given, near, asked, proving.limits, tuple(options.without), _general(loaded, proving),
        bands.see if options.out is not None else None, (lambda _: None) if proving.quiet else _say,
    )  # fmt: skip
    findings = around.findings()
    if options.out is not None:
        _write(options.out, loaded, run, bands, findings, quiet=proving.quiet)
    return result(findings, [loaded], as_json=proving.quiet)


def _require_truth(loaded: Target, run: Recorded, within: Sequence[str], name: str) -> None:
    """Refuse a ghost in --within where the stream does not hold the truth."""
    ghosts = [var.name for var in loaded.system.ghosts if var.name in within]
    if ghosts and not run.given.ghosts:
        raise InputError(f"--within {ghosts[0]}: it is a ghost, and {name} does not hold the truth; leave it out.")


def _say(text: str) -> None:
    err.print(text, markup=False)


# ------------------------------------------------------------------ the stream


def _stream(target: str, options: AroundOptions, config: Path | None) -> tuple[Target, StepStream, str]:
    """Return the target with a stream of it, and the name of the stream."""
    if options.simulate is not None and options.stream is not None:
        raise InputError("--around and --simulate exclude each other: give a stream, or have one simulated.")
    loaded = load_target(target, config)
    if options.simulate is not None:
        return _Simulation(target, loaded, config, _settings(options.simulate)).stream()
    path = find_recording(loaded, Path(options.stream or ""))
    stream, _ = read_recording(loaded, path)
    return loaded, stream, recording_name(path)


def _settings(text: str) -> dict[str, str]:
    """Return what `line=fig3,seed=7,faults=a,b` sets: a part without `=` goes on the setting before it."""
    found: dict[str, str] = {}
    last = ""
    for part in text.split(","):
        key, sign, value = part.partition("=")
        if sign:
            last = key.strip()
            found[last] = value.strip()
        elif last:
            found[last] += f",{part.strip()}"
        else:
            raise InputError(f"--simulate {text!r}: expected settings such as line=fig3,seed=7.")
    unknown = next((key for key in found if key not in _SETTINGS), None)
    if unknown is not None:
        raise InputError(
            f"--simulate: no setting {unknown!r}; there are {', '.join(_SETTINGS)}.{hint(unknown, _SETTINGS)}"
        )
    return found


_SETTINGS = ("line", "seed", "faults", "vehicle")


@dataclass(frozen=True)
class _Simulation:
    """A simulated stream: of the machine alone, or of a vehicle on a line."""

    target: str
    loaded: Target
    config: Path | None
    settings: Mapping[str, str] = field(default_factory=dict)

    def stream(self) -> tuple[Target, StepStream, str]:
        name = "simulated " + ",".join(f"{key}={value}" for key, value in self.settings.items())
        loaded, steps = self._on_a_line() if "line" in self.settings else (self.loaded, self._alone())
        return loaded, StepStream(tuple(steps), tuple(range(1, len(steps) + 1)), machine=loaded.name), name

    @property
    def _seed(self) -> int:
        text = self.settings.get("seed", "0")
        if not text.isdecimal():
            raise InputError(f"--simulate seed={text}: a seed is a whole number from 0 on.")
        return int(text)

    def _alone(self) -> Sequence[Mapping[str, int | bool | str]]:
        of_lines = [key for key in self.settings if key != "seed"]
        if of_lines:
            raise InputError(f"--simulate {of_lines[0]}: only a line has it; give line=NAME too.")
        if self.loaded.simulate is None:
            raise InputError(
                f"{self.loaded.name} has no simulation; give a recording in --around, or line=NAME in --simulate."
            )
        return list(self.loaded.simulate(self._seed))

    def _on_a_line(self) -> tuple[Target, Sequence[Mapping[str, int | bool | str]]]:
        from safeloc.cli.simulate_line import LineOptions, runs_on_line  # numpy is loaded only where it is needed

        vehicles = (self.settings["vehicle"],) if "vehicle" in self.settings else ()
        faults = (self.settings["faults"],) if self.settings.get("faults") else ()
        options = LineOptions((self.loaded.name,), vehicles, faults=faults, seed=self._seed)
        run = runs_on_line(self.settings["line"], options)[0]
        loaded = self.loaded
        if self.config is None and run.stream.config != loaded.config:
            loaded = ENTRIES[self.target].make(run.stream.config)
        return loaded, list(run.stream.steps)


# ------------------------------------------------------------------ what is asked


def _figures(option: str, given: Sequence[str]) -> dict[str, int]:
    """Return the figures of NAME=FIGURE, separated by commas or in options of their own."""
    found: dict[str, int] = {}
    for part in (one.strip() for text in given for one in text.split(",")):
        name, sign, figure = part.partition("=")
        name = name.strip()
        if not sign or not name or not re.fullmatch(r"[0-9]+", figure.strip()):
            raise InputError(
                f"{option} {part!r}: expected NAME=NUMBER, a whole number from 0 on in the unit of the input."
            )
        if name in found:
            raise InputError(f"{option}: {name} is given twice.")
        found[name] = int(figure)
    return found


def _asked(loaded: Target, options: AroundOptions, only: list[str] | None, cycles: int) -> list[Asked]:
    first, last = options.first, options.last
    if (first is not None or last is not None) and not options.claims:
        raise InputError("--from and --until say in which cycles a --claim is judged; give a claim, or leave them out.")
    if not 1 <= (first or 1) <= (last or cycles) <= cycles:
        raise InputError(f"--from {first or 1} --until {last or cycles}: the stream has the cycles 1 to {cycles}.")
    own = [written_claim(loaded.system, text, first or 1, last) for text in options.claims]
    if own and only is None:
        return own
    chosen = chosen_properties(loaded, only)
    runs = [prop.name for prop in chosen if prop.kind == "reachable"]
    if only is not None and runs:
        raise InputError(f"--property {runs[0]!r} asks for some run, and a tube is asked what all its streams keep.")
    declared = [Asked(prop) for prop in chosen if prop.kind != "reachable"]
    if not own and not declared:
        raise InputError(f'{loaded.name} declares no property; write a claim, such as --claim "valid".')
    return [*own, *declared]


def _laws(loaded: Target, names: Sequence[str]) -> list[ClauseId]:
    """Return the clauses of these names, with or without their machine."""
    known = {str(one): one for one in assumed_clauses(loaded.system)}
    by_name: dict[str, list[ClauseId]] = {}
    for one in known.values():
        by_name.setdefault(one.name, []).append(one)
    found = []
    for name in names:
        some = [known[name]] if name in known else by_name.get(name, [])
        if not some:
            every = list(by_name)
            raise InputError(
                f"--without: {loaded.name} assumes no law {name!r}; it assumes {'; '.join(every)}.{hint(name, every)}"
            )
        if len(some) > 1:
            raise InputError(
                f"--without: several machines have a law {name!r}; give one of {', '.join(map(str, some))}."
            )
        found += some
    return found


def _general(loaded: Target, proving: Proving) -> General:
    def general(prop: Property) -> Mapping[str, str] | None:
        found = prove_target(loaded, only=[prop.name], limits=proving.limits, jobs=1, store=proving.store)
        [one] = [finding for finding in found if finding.id.endswith(f"/{prop.name}")]
        return one.result.certificates if isinstance(one.result, Proved) else None

    return general


# ------------------------------------------------------------------ what is written


def _drawn(loaded: Target, asked: Sequence[Asked], within: Sequence[str]) -> list[str]:
    """Return the numbers to draw: those in --within and in claims, and the reported interval."""
    reported = list(loaded.reported.outputs) if loaded.reported is not None else []
    names = dict.fromkeys([*within, *(name for one in asked for name in one.reads), *reported])
    known = signals(loaded.system)
    return [name for name in names if isinstance(known.get(name), Num)]


def _write(
    folder: Path, loaded: Target, run: Recorded, bands: Bands, findings: Sequence[Finding], *, quiet: bool
) -> None:
    """Write a picture of each signal, the stream of each violation, and the certificates."""
    broken = [len(one.result.trace.steps) for one in findings if isinstance(one.result, Violated) and one.result.trace]
    try:
        (folder / "certificates").mkdir(parents=True, exist_ok=True)
        pictures = file_names(list(bands.names))
        for name in bands.names:
            term = signals(loaded.system)[name]
            unit = term.unit.name if isinstance(term, Num) else ""
            shown = (
                name, unit, recorded_series(run.trace, loaded.system, name), bands.series(name, run.given.length),
                min(broken) if broken else None,
            )  # fmt: skip
            for kind, picture in (("", tube_picture(*shown)), ("-deviation", deviation_picture(*shown))):
                if picture:
                    _write_text(folder / f"tube-{pictures[name]}{kind}.svg", picture, quiet=quiet)
        files = file_names([one.id.rpartition("/")[2] for one in findings])
        for one in findings:
            _write_evidence(folder / files[one.id.rpartition("/")[2]], loaded, one, quiet=quiet)
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error}") from error


def _write_text(path: Path, text: str, *, quiet: bool) -> None:
    path.write_text(text, encoding="utf-8")
    if not quiet:
        _say(str(path))


def _write_evidence(file: Path, loaded: Target, finding: Finding, *, quiet: bool) -> None:
    match finding.result:
        case Violated(trace=trace) if trace is not None:
            path = file.with_name(f"{file.name}.jsonl")
            first = {
                var.name: trace.initial[var.name] for var in trace.system.state if trace.system.initial[var] is ANY
            }
            write_steps(path, trace.stream(), machine=loaded.name, first=first)
            if not quiet:
                _say(f"safeloc replay {loaded.spec or loaded.name} {path}")
        case Proved(certificates=texts):
            for name, text in texts.items():
                (file.parent / "certificates" / name).write_text(text, encoding="utf-8")
        case _:
            pass
