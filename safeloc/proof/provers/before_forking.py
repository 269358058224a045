"""Preparation before processes are forked, and before a process begins another task: what every task of a prover needs, and finds."""

from __future__ import annotations

import z3

from safeloc import yices


def prepare() -> None:
    """Make z3's context and look for yices, unless this process has both.

    A context takes 4,500 new pages of memory, the look for yices a process. An empty context is the same in every process, so no
    answer depends on where it was made.
    """
    z3.main_ctx()
    yices.version()


def renew() -> None:
    """Give this process an empty context of z3 in place of its own: a task that follows others in a process begins as in a new one.

    The terms of the former context go with it, as soon as nothing holds them any more. It takes 1 ms, a new process 10.
    """
    z3.z3._main_ctx = None  # the context that z3.main_ctx() makes anew
    z3.main_ctx()
