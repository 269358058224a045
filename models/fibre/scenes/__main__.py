"""Make the shipped fibre recordings anew: python -m safeloc.models.fibre.scenes [folder].

Without a folder each goes to its machine's own.
"""

from __future__ import annotations

import sys
from pathlib import Path

from safeloc.models.fibre.scenes.recordings import recordings

MODELS = Path(__file__).parents[2]


def main() -> None:
    """Write each recording as soon as it is made."""
    for recording in recordings():
        recording.write(Path(sys.argv[1]) if len(sys.argv) > 1 else MODELS / recording.machine / "recordings")
        print(recording.name, len(recording.steps), "steps")


if __name__ == "__main__":
    main()
