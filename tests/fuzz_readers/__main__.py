"""Fuzz the readers, one after the other, each for as long as told.

    python -m tests.fuzz_readers --seconds 600 --out FILE [--reader railML] [--seed 1] [--corpus FOLDER]

With atheris (pip install atheris, Linux) changes are led by the lines of safeloc that they reach, and what reached new
ones is kept in the corpus. Without it, or with --plain, changes are random.

A reader is a line of FILE; started again with the same FILE, readers that have passed for as long are not tried again. The
last line of output is `N passed, N failed`, of readers; the exit code is 1 where one failed. One whose extra is not installed is
told, and counts as neither.
"""

from __future__ import annotations

import argparse
import importlib.util
import re
import subprocess
import sys
import time
import traceback
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from tests.kept_lines import keep, kept_lines

SKIPPED = "its extra is not installed"


@dataclass(frozen=True)
class Tried:
    """A reader, what it was given, and what it did that no reader may; `branches` only where changes were led by them."""

    reader: str
    seconds: float
    seed: int
    guided: bool
    inputs: int
    branches: int = 0
    defect: str = ""

    def words(self) -> str:
        """In a line, with the defect behind it."""
        led = f", {self.branches} branches" if self.guided else ""
        return f"{self.reader}: {self.inputs} inputs{led} in {self.seconds:g} s\n{self.defect}".rstrip()


def main(arguments: Sequence[str] | None = None) -> int:
    """0: nothing but documented refusals. 1: a defect, with the input that shows it."""
    chosen = _arguments(arguments)
    if chosen.guided:
        return guided(chosen.guided, chosen.seconds, chosen.seed, chosen.corpus)
    led = importlib.util.find_spec("atheris") is not None and not chosen.plain
    print("led by coverage (atheris)" if led else "random changes; not led by coverage, for which install atheris")
    done = _passed(chosen, led)
    readers = list(chosen.reader or names())
    print(f"{len(readers)} readers, {sum(name in done for name in readers)} of them in {chosen.out}", flush=True)
    for name in readers:
        if name in done:
            print(done[name].words(), flush=True)
    found = [one for name in readers if (one := done.get(name) or _one(name, chosen, led)) is not None]
    failed = sum(bool(one.defect) for one in found)
    print(f"{len(found) - failed} passed, {failed} failed")
    return 1 if failed else 0


def _arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz_readers", description="Readers are given anything.")
    parser.add_argument("--seconds", type=float, default=600, help="for each reader")
    parser.add_argument("--reader", action="append", help="only this one (repeatable)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="a line a reader; read again to go on")
    parser.add_argument("--corpus", type=Path, default=Path("long/fuzz-corpus"))
    parser.add_argument("--plain", action="store_true", help="random changes, also where atheris is installed")
    parser.add_argument("--guided", metavar="READER", help=argparse.SUPPRESS)  # one reader in a process of its own
    return parser.parse_args(arguments)


def names() -> list[str]:
    """All readers."""
    from tests.fuzz_readers.readers import FUZZED

    return [one.name for one in FUZZED]


def _passed(chosen: argparse.Namespace, led: bool) -> dict[str, Tried]:
    """What stands in the file, passed, and tried in this way for as long as asked for."""
    tried = [Tried(**line) for line in kept_lines(chosen.out)] if chosen.out else []
    return {
        one.reader: one
        for one in tried
        if not one.defect and (one.seed, one.guided) == (chosen.seed, led) and one.seconds >= chosen.seconds
    }


def _one(name: str, chosen: argparse.Namespace, led: bool) -> Tried | None:
    """A reader, tried and kept; None where its extra is not installed."""
    if not _examples(name):
        print(f"{name}: skipped, {SKIPPED}", flush=True)
        return None
    tried = _led(name, chosen) if led else plain(name, chosen.seconds, chosen.seed)
    if chosen.out:
        keep(chosen.out, asdict(tried))
    print(tried.words(), flush=True)
    return tried


def _examples(name: str) -> list[bytes]:
    from tests.fuzz_readers.readers import FUZZED

    return [data for one in FUZZED if one.name == name for data in one.examples()]


def _led(name: str, chosen: argparse.Namespace) -> Tried:
    """In a process of its own, for libFuzzer ends it."""
    options = ["--seconds", str(chosen.seconds), "--seed", str(chosen.seed), "--corpus", str(chosen.corpus)]
    done = subprocess.run(
        [sys.executable, "-m", "tests.fuzz_readers", "--guided", name, *options],
        capture_output=True, text=True, errors="replace", check=False,
    )  # fmt: skip
    told = f"{done.stdout}{done.stderr}"
    runs = re.findall(r"#(\d+)\s+\w+\s+cov: (\d+)", told)
    inputs, branches = map(int, runs[-1]) if runs else (0, 0)
    defect = (
        f"exit {done.returncode}: {told[-4_000:]}" if done.returncode else "" if runs else f"no input: {told[-4_000:]}"
    )
    return Tried(name, chosen.seconds, chosen.seed, True, inputs, branches, defect)


def plain(name: str, seconds: float, seed: int) -> Tried:
    """Random changes of the sound examples and of what is kept."""
    from random import Random

    from tests.fuzz_readers.changes import changed
    from tests.fuzz_readers.kept import KEPT
    from tests.fuzz_readers.readers import FUZZED

    fuzzed = next(one for one in FUZZED if one.name == name)
    examples, random = _examples(name), Random(f"{name} {seed}")
    first = [*examples, *KEPT.get(name, ())]
    end, count = time.monotonic() + seconds, 0
    while count < len(first) or time.monotonic() < end:
        data = first[count] if count < len(first) else changed(examples, random)
        count += 1
        try:
            fuzzed.read(data)
        except Exception:
            defect = f"input {count} of seed {seed}: {data[:2_000]!r}\n{traceback.format_exc()}"
            return Tried(name, seconds, seed, False, count, defect=defect)
    return Tried(name, seconds, seed, False, count)


def guided(name: str, seconds: float, seed: int, corpus: Path) -> int:
    """One reader under atheris; its corpus is kept in a folder of its own."""
    import atheris

    with atheris.instrument_imports(include=["safeloc"]):
        from tests.fuzz_readers.kept import KEPT
        from tests.fuzz_readers.readers import FUZZED
    fuzzed = next(one for one in FUZZED if one.name == name)
    own = corpus / re.sub(r"\W+", "-", name)
    own.mkdir(parents=True, exist_ok=True)
    for number, data in enumerate((*fuzzed.examples(), *KEPT.get(name, ()))):
        (own / f"example-{number}").write_bytes(data)
    limits = [f"-max_total_time={int(seconds)}", f"-seed={seed}", "-max_len=65536", "-timeout=60", "-rss_limit_mb=4096"]
    atheris.Setup([sys.argv[0], *limits, f"-artifact_prefix={own.parent}/", str(own)], fuzzed.read)
    atheris.Fuzz()
    return 0


if __name__ == "__main__":
    sys.exit(main())
