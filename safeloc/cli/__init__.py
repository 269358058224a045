"""The command line: `safeloc list | prove | test | simulate | replay | report | export | verify`.

Exit codes: 0 all holds, 1 something is violated, 2 wrong usage or input, 3 undecided within the limits.
"""

from safeloc.cli.main import main

__all__ = ["main"]
