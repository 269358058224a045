"""`safeloc prove TARGET --around STREAM`: a proof over all streams near a given one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from safeloc.cli.around_folder import drawn, make_folder, write_certificate, write_folder
from safeloc.cli.around_question import asked, figures, general, laws
from safeloc.cli.around_stream import given_stream
from safeloc.cli.console import err
from safeloc.cli.show import result
from safeloc.errors import InputError
from safeloc.proof.around.bands import Bands
from safeloc.proof.around.deviations import deviations
from safeloc.proof.around.given import Recorded, recorded
from safeloc.proof.around.proving import Around
from safeloc.proof.around.shown import decided_data
from safeloc.proof.cache.store import Store
from safeloc.proof.cores.clauses import without
from safeloc.proof.provers.limits import Limits
from safeloc.target import Target


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
    timeout: float | None = None

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
            "--timeout": self.timeout,
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
    loaded, stream, name = given_stream(target, options.stream, options.simulate, proving.config)
    run = recorded(loaded, Path(name), stream)
    system = without(loaded.system, laws(loaded, options.without)) if options.without else loaded.system
    near = deviations(
        loaded.system,
        figures("--within", options.within),
        figures("--drop", options.drop),
        figures("--delay", options.delay),
    )
    _require_truth(loaded, run, list(near.widths), name)
    if options.out is not None:
        make_folder(options.out)
    wanted = asked(loaded, options.claims, (options.first, options.last), proving.only, run.given.length)
    bands = Bands(loaded.system, drawn(loaded, wanted, list(near.widths)))
    around = Around(
        loaded.name,
        system,
        name,
        run.given,
        near,
        wanted,
        proving.limits,
        tuple(options.without),
        general(loaded, proving.limits, proving.store),
        bands.see if options.out is not None else None,
        (lambda _: None) if proving.quiet else _say,
        math.inf if options.timeout is None else options.timeout,
    )
    decided = around.decided()
    if options.out is not None:
        write_folder(options.out, loaded, run, bands, decided.findings, quiet=proving.quiet)
        question = decided_data(decided, wanted, near, options.without)
        write_certificate(options.out, loaded, (name, stream), question, decided)
    return result(decided.findings, [loaded], as_json=proving.quiet)


def _require_truth(loaded: Target, run: Recorded, within: Sequence[str], name: str) -> None:
    """Refuse a ghost in --within where the stream does not hold the truth."""
    ghosts = [var.name for var in loaded.system.ghosts if var.name in within]
    if ghosts and not run.given.ghosts:
        raise InputError(f"--within {ghosts[0]}: it is a ghost, and {name} does not hold the truth; leave it out.")


def _say(text: str) -> None:
    err.print(text, markup=False)
