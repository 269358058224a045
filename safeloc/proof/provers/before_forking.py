"""Preparation before processes are forked: what every process of a prover needs is made once, and each finds it."""

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
