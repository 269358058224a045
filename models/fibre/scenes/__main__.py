"""Make the shipped fibre recordings anew: python -m safeloc.models.fibre.scenes [folder, by default models/streams]."""

from __future__ import annotations

import sys
from pathlib import Path

from safeloc.models.fibre.scenes.recordings import recordings

FOLDER = Path(__file__).parents[2] / "streams"


def main() -> None:
    """Write each recording as soon as it is made."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    for recording in recordings():
        recording.write(folder)
        print(recording.name, len(recording.steps), "steps")


if __name__ == "__main__":
    main()
