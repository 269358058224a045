"""The command line. What each command is for stands in safeloc.cli.commands; its module is loaded when it is called.

Exit codes: 0 all holds, 1 something is violated, 2 no result (wrong usage or input, or safeloc itself failed),
3 undecided within the limits; 130 interrupted, 141 closed pipe.
"""

from safeloc.cli.entry import main

__all__ = ["main"]
