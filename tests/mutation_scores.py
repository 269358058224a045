"""Write the mutation results that ship: `python -m tests.mutation_scores [--cache FOLDER] MACHINE ...` writes MACHINE.mutation.json.

Run this after `safeloc mutate MACHINE` with the same cache: the score and the strengths that it kept for the machine as it stands are
written. A machine of which not all mutants were judged is an error, unless --sample is given.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from safeloc.assurance.mutation.kept_score import SCORES
from safeloc.assurance.mutation.shipped_scores import write_shipped_score
from safeloc.assurance.mutation.strength import kept_strengths
from safeloc.catalogue import load_target
from safeloc.proof.cache.store import Store, usual_folder


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the files of the named machines."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutation_scores", description=__doc__.splitlines()[0])
    parser.add_argument("--cache", type=Path, default=usual_folder())
    parser.add_argument("--sample", action="store_true", help="a sample may be written")
    parser.add_argument("machine", nargs="+")
    asked = parser.parse_args(arguments)
    for name in asked.machine:
        target, store = load_target(name), Store(asked.cache)
        score = SCORES.kept(store, target)
        if score is None:
            parser.error(f"nothing is kept of {name} in {asked.cache}: run `safeloc mutate {name}` first")
        if score["judged"] < score["mutants"] and not asked.sample:
            parser.error(
                f"{score['judged']} of {score['mutants']} mutants of {name} were judged: judge all, or give --sample"
            )
        path = write_shipped_score(target, score, kept_strengths(store, target))
        print(f"{path}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
