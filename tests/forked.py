"""Programs in a process that is forked from that of the tests: they need not load anew what it has loaded."""

from __future__ import annotations

import faulthandler
import gc
import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Mapping, Sequence
from typing import NoReturn

_FIRST_OTHER_FD = 3


def instead_of_exec(
    program: Callable[[], object], words: Sequence[str], environment: Mapping[str, str] | None = None,
    before: Callable[[], None] | None = None,
) -> Callable[[], NoReturn]:  # fmt: skip
    """Return what a child of `subprocess` calls last: there the program runs with these words, and no other one is loaded.

    Streams, folder and process group are those that `subprocess` gave it. It has nothing open that another program would
    not have, and handles signals as that would. Give `restore_signals=False`: what Python ignores is ignored.
    """

    def begin() -> NoReturn:
        code = 1
        try:
            if before is not None:
                before()
            _become(words, environment)
            code = _run_to_its_end(program)
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(code)

    return begin


def _become(words: Sequence[str], environment: Mapping[str, str] | None) -> None:
    """Leave what belongs to the tests: open files, garbage that would close them once more, handlers, streams, environment."""
    gc.freeze()
    gc.enable()
    faulthandler.disable()
    os.closerange(_FIRST_OTHER_FD, os.sysconf("SC_OPEN_MAX"))
    for number in signal.valid_signals():
        if callable(handler := signal.getsignal(number)) and handler is not signal.default_int_handler:
            signal.signal(number, signal.SIG_DFL)
    sys.stdin = os.fdopen(0, closefd=False)
    sys.stdout = os.fdopen(1, "w", closefd=False)
    sys.stderr = os.fdopen(2, "w", buffering=1, errors="backslashreplace", closefd=False)
    sys.argv = [*words]
    if environment is not None:
        os.environ.clear()
        os.environ.update(environment)


def _run_to_its_end(program: Callable[[], object]) -> int:
    """Return the exit code that an interpreter would have ended with."""
    try:
        code = program()
    except SystemExit as end:
        code = end.code
    for thread in threading.enumerate():
        if thread is not threading.current_thread() and not thread.daemon:
            thread.join()
    sys.stdout.flush()
    sys.stderr.flush()
    assert code is None or isinstance(code, int), code
    return code or 0
