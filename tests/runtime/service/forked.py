"""The command `safeloc` in a process that is forked from that of the tests: it need not load anew what they have loaded."""

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

from safeloc.cli import main

_FIRST_OTHER_FD = 3


def instead_of_exec(
    arguments: Sequence[str], environment: Mapping[str, str] | None, before: Callable[[], None] | None = None
) -> Callable[[], NoReturn]:
    """Return what a child of `subprocess` calls last: there it is `safeloc ARGUMENTS`, and no other program is loaded.

    Streams, folder and process group are those that `subprocess` gave it. It has nothing open that another program would
    not have, and handles signals as that would. Give `restore_signals=False`: what Python ignores is ignored.
    """

    def begin() -> NoReturn:
        code = 1
        try:
            if before is not None:
                before()
            _become(arguments, environment)
            code = _run_to_its_end()
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(code)

    return begin


def _become(arguments: Sequence[str], environment: Mapping[str, str] | None) -> None:
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
    sys.argv = ["safeloc", *arguments]
    if environment is not None:
        os.environ.clear()
        os.environ.update(environment)


def _run_to_its_end() -> int:
    """Return the exit code that an interpreter would have ended with."""
    try:
        main()
        code: object = None
    except SystemExit as end:
        code = end.code
    for thread in threading.enumerate():
        if thread is not threading.current_thread() and not thread.daemon:
            thread.join()
    sys.stdout.flush()
    sys.stderr.flush()
    assert code is None or isinstance(code, int), code
    return code or 0
