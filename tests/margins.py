"""Write the margins that ship: `python -m tests.margins [--cache FOLDER] MACHINE ...` writes MACHINE.margins.json into its folder.

Run this after `safeloc margins MACHINE` and `safeloc margins MACHINE --pairs` with the same cache: what those found and kept for the
machine as it stands is written, and of what they did not ask what the file has already, if it is of this version of the machine. A machine
of which nothing is kept is an error.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from safeloc.assurance.margins.kept_margins import MARGINS
from safeloc.assurance.margins.shipped_margins import shipped_margins, write_shipped
from safeloc.catalogue import load_target
from safeloc.proof.cache.store import Store, usual_folder, utc_now

SECONDS = 10.0
"""The limit of `safeloc margins` without --seconds."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the files of the named machines."""
    parser = argparse.ArgumentParser(prog="python -m tests.margins", description=__doc__.splitlines()[0])
    parser.add_argument("--cache", type=Path, default=usual_folder())
    parser.add_argument("--seconds", type=float, default=SECONDS)
    parser.add_argument("machine", nargs="+")
    asked = parser.parse_args(arguments)
    for name in asked.machine:
        target = load_target(name)
        parts = MARGINS.kept(Store(asked.cache), target)
        if parts is None:
            parser.error(f"nothing is kept of {name} in {asked.cache}: run `safeloc margins {name}` first")
        shipped = shipped_margins(target)
        parts = {**({} if shipped is None else shipped.parts), **parts}
        path = write_shipped(target, parts, utc_now()[:10], asked.seconds)
        print(f"{path}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
