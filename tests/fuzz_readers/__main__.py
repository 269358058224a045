"""Fuzz the readers, one after the other, each for as long as told.

    python -m tests.fuzz_readers --seconds 600 [--reader railML] [--seed 1] [--corpus FOLDER]

With atheris (pip install atheris, Linux) changes are led by the lines of safeloc that they reach, and what reached new
ones is kept in the corpus. Without it, or with --plain, changes are random.
"""

from __future__ import annotations

import argparse
import importlib.util
import re
import subprocess
import sys
import time
from pathlib import Path


def main() -> int:
    """0: nothing but documented refusals. 1: a defect, with the input that shows it."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz_readers", description="Readers are given anything.")
    parser.add_argument("--seconds", type=float, default=600, help="for each reader")
    parser.add_argument("--reader", action="append", help="only this one (repeatable)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--corpus", type=Path, default=Path("long/fuzz-corpus"))
    parser.add_argument("--plain", action="store_true", help="random changes, also where atheris is installed")
    parser.add_argument("--guided", metavar="READER", help=argparse.SUPPRESS)  # one reader in a process of its own
    chosen = parser.parse_args()
    if chosen.guided:
        return guided(chosen.guided, chosen.seconds, chosen.seed, chosen.corpus)
    with_atheris = importlib.util.find_spec("atheris") is not None and not chosen.plain
    print(
        "led by coverage (atheris)"
        if with_atheris
        else "random changes; not led by coverage, for which install atheris"
    )
    return max([_one(name, chosen, with_atheris) for name in chosen.reader or names()], default=0)


def names() -> list[str]:
    """All readers."""
    from tests.fuzz_readers.readers import FUZZED

    return [one.name for one in FUZZED]


def _one(name: str, chosen: argparse.Namespace, with_atheris: bool) -> int:
    if not with_atheris:
        return plain(name, chosen.seconds, chosen.seed)
    options = ["--seconds", str(chosen.seconds), "--seed", str(chosen.seed), "--corpus", str(chosen.corpus)]
    done = subprocess.run(
        [sys.executable, "-m", "tests.fuzz_readers", "--guided", name, *options],
        capture_output=True, text=True, errors="replace", check=False,
    )  # fmt: skip
    told = f"{done.stdout}{done.stderr}"
    runs = re.findall(r"#(\d+)\s+\w+\s+cov: (\d+)", told)
    print(
        f"{name}: {runs[-1][0] if runs else '?'} inputs, {runs[-1][1] if runs else '?'} branches, exit {done.returncode}",
        flush=True,
    )
    if done.returncode:
        print(told[-4_000:])
    return 1 if done.returncode else 0


def plain(name: str, seconds: float, seed: int) -> int:
    """Random changes of the sound examples and of what is kept."""
    from random import Random

    from tests.fuzz_readers.changes import changed
    from tests.fuzz_readers.kept import KEPT
    from tests.fuzz_readers.readers import FUZZED

    fuzzed = next(one for one in FUZZED if one.name == name)
    examples, random = list(fuzzed.examples()), Random(f"{name} {seed}")
    if not examples:
        print(f"{name}: skipped, its extra is not installed")
        return 0
    end, count = time.monotonic() + seconds, 0
    for data in (*examples, *KEPT.get(name, ())):
        fuzzed.read(data)
    while time.monotonic() < end:
        data, count = changed(examples, random), count + 1
        try:
            fuzzed.read(data)
        except BaseException:
            print(f"{name}: input {count} of seed {seed}: {data[:2_000]!r}")
            raise
    print(f"{name}: {count} inputs", flush=True)
    return 0


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
