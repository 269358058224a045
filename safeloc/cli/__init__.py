"""The command line: `safeloc list | prove | test | simulate | replay | report | export | verify | import | audit`.

Exit codes: 0 all holds, 1 something is violated, 2 no result (wrong usage or input, or safeloc itself failed),
3 undecided within the limits; 130 interrupted, 141 closed pipe.
"""

from safeloc.cli.main import main

__all__ = ["main"]
