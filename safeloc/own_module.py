"""A machine of a user's own module, with what the module declares beside it: properties, recordings, simulation, pictures."""

from __future__ import annotations

import difflib
import importlib
import importlib.util
import reprlib
import sys
import traceback
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from importlib.machinery import SourceFileLoader
from inspect import isfunction
from pathlib import Path
from types import CodeType, ModuleType
from typing import TYPE_CHECKING, Any, cast

from safeloc.errors import InputError, SafelocError
from safeloc.language.composition import Composition
from safeloc.language.interpret import start
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, lower
from safeloc.reported import Reported, usual_names
from safeloc.simulated import SimulatedRun, Steps
from safeloc.target import Hazard, Simulate, Target

if TYPE_CHECKING:
    from safeloc.railway.pictures import Picture

_NEARLY = ("properties", "property", "props")
"""Names that look like a misspelt `properties`."""


def own_target(
    spec: str, config: Path | None, given: Mapping[str, Any] | None, *, with_recordings: bool = True
) -> Target:
    """Return the machine at `file.py:name` or `package.module:name`; `given` is the content of the configuration file.

    with_recordings  read what the module says of recordings; False where one of them may be about to be made

    InputError for a module that cannot be loaded, and for declarations of the wrong form.
    """
    where, _, name = spec.rpartition(":")
    module = load_module(where)
    if not hasattr(module, name):
        raise InputError(f"{where} has no {name!r}{_made(module)}")
    found = getattr(module, name)
    if isinstance(found, type):
        raise InputError(
            f"{spec} is a class; name a machine, a composition, or a function that returns one{_made(module)}"
        )
    if callable(found):
        with as_input_error(spec):
            found = found(given) if given is not None else found()
    elif config is not None:
        raise InputError(f"{config}: {spec} takes no configuration; name a function that gets its content.")
    if not isinstance(found, (Machine, Composition)):
        raise InputError(
            f"{spec} is of type {type(found).__name__}; expected a Machine, a Composition or a function returning one."
        )
    streams = _recordings(module, found) if with_recordings else ()
    if isinstance(found, Machine):
        return replace(_target(module, found, lower(found), found.doc), given=given, streams=streams)
    return replace(_target(module, found, found.system, ""), given=given, streams=streams)


def _made(module: ModuleType) -> str:
    """Return the end of a message: the names of the machines and compositions of a module."""
    names = [key for key, value in vars(module).items() if isinstance(value, (Machine, Composition))]
    return f"; machines in it: {names or 'none'}."


def _target(module: ModuleType, found: Machine | Composition, system: TransitionSystem, doc: str) -> Target:
    declared = getattr(module, "reported", None)
    reported = declared if isinstance(declared, Reported) else usual_names(module.__name__, system.outputs)
    missing = [name for name in reported.outputs if name not in system.outputs] if reported else []
    if missing:
        raise InputError(f"{module.__name__}.reported names {missing[0]!r}; outputs are {', '.join(system.outputs)}.")
    properties = _properties(module, found)
    return Target(
        system.name,
        system.machines,
        system,
        properties,
        None,
        doc,
        reported=reported,
        simulate=_simulation(module, system),
        pictures=_pictures(module, system),
        unasked="" if properties else _unasked(module),
        hazard=_hazard(module),
    )


def _hazard(module: ModuleType) -> Hazard | None:
    """Return the hazard that a user's module declares, if it does; InputError for anything else of that name."""
    declared = getattr(module, "hazard", None)
    if declared is None or isinstance(declared, Hazard):
        return declared
    what = 'expected Hazard("what must not happen", ("name of a property", ...)) of safeloc.target'
    raise InputError(f"{module.__name__}.hazard is {_described(declared)} ({_file(module)}); {what}.")


def _recordings(module: ModuleType, found: Machine | Composition) -> tuple[Path, ...]:
    """Return the recordings that a user's module names, by their paths from its file; InputError for one that is not there."""
    named = _listed(module, "recordings", _declared(module, "recordings", found))
    for item in named:
        if not isinstance(item, (str, Path)):
            raise InputError(f"{module.__name__}.recordings holds {_described(item)}; expected paths of files.")
    paths = tuple(Path(_file(module)).parent / item for item in named)
    for path in paths:
        if not path.is_file():
            what = f"no such file, but {module.__name__}.recordings names it; correct the path, or leave it out of the list"
            raise InputError(f"{path}: {what}.")
    return paths


def _simulation(module: ModuleType, system: TransitionSystem) -> Simulate | None:
    """Return the function `simulate` of a user's module, if it has one; InputError for anything else of that name.

    First values that its runs choose are checked when it is called.
    """
    declared = getattr(module, "simulate", None)
    if declared is None or isinstance(declared, ModuleType):  # a package may have a file simulate.py
        return None
    if not callable(declared):
        what = "expected a function of a seed that returns the steps of a run"
        raise InputError(f"{module.__name__}.simulate is {_described(declared)} ({_file(module)}); {what}.")

    def simulated(seed: int) -> Steps:
        with as_input_error(f"{module.__name__}.simulate"):
            made = cast(Simulate, declared)(seed)
            steps = [dict(step) for step in made]
            if not isinstance(made, SimulatedRun):
                return steps
            start(system, made.first)
            return SimulatedRun(steps, dict(made.first))

    return simulated


def _unasked(module: ModuleType) -> str:
    """Explain why a module's machine has no property: the name searched for, the file, and the remedy."""
    declared = vars(module).get("properties")
    if declared is not None:
        made = "the function `properties` returned none" if callable(declared) else "the list `properties` is empty"
        return f"{_file(module)}: {made}; declare in it what must hold, such as always(...), or nothing is proved."
    other = _other_name(module)
    if other:
        return f"{_file(module)}: there is no `properties`, but there is {other!r}; make it a list called `properties`."
    return (
        f"{_file(module)}: no `properties` in it; declare what must hold, such as "
        "properties = [always(...), within(...)], or a function of the machine that returns such a list."
    )


def _other_name(module: ModuleType) -> str:
    """Return the name under which the module seems to declare its properties; empty if nothing looks like it."""
    members = {name: value for name, value in vars(module).items() if not name.startswith("_")}
    for name, value in members.items():
        if isinstance(value, (list, tuple)) and value and all(isinstance(item, Property) for item in value):
            return name
    alone = [name for name, value in members.items() if isinstance(value, Property)]
    callables = [name for name, value in members.items() if isinstance(value, (list, tuple)) or isfunction(value)]
    close = [name for name in callables if difflib.get_close_matches(name.casefold(), _NEARLY, n=1, cutoff=0.8)]
    return (close or alone or [""])[0]


def _pictures(module: ModuleType, system: TransitionSystem) -> tuple[Picture, ...]:
    declared = _listed(module, "pictures", getattr(module, "pictures", ()))
    if not declared:
        return ()
    from safeloc.railway.pictures import Picture, unreadable  # whoever draws nothing needs none of the railway

    wrong = [item for item in declared if not isinstance(item, Picture)]
    if wrong:
        raise InputError(
            f"{module.__name__}.pictures holds {_described(wrong[0])}; expected Deviation, Approach or Recognition."
        )
    for picture in declared:
        missing = unreadable(picture, system)
        if missing:
            raise InputError(f"{module.__name__}.pictures, {picture.title!r}: {'; '.join(missing)}.")
    return tuple(declared)


class _AsItStands(SourceFileLoader):
    """Compiles the text of the file as it is now, never byte code kept beside it.

    Python takes a file of equal size and second of change for unchanged: a guard that was edited from 5 to 6 within a second would
    be proved as it was before.
    """

    def get_code(self, fullname: str) -> CodeType:
        path = self.get_filename(fullname)
        return self.source_to_code(self.get_data(path), path)


@contextmanager
def _no_byte_code() -> Iterator[None]:
    """Keep no byte code of what a user's file imports, for the same reason."""
    before = sys.dont_write_bytecode
    sys.dont_write_bytecode = True
    try:
        yield
    finally:
        sys.dont_write_bytecode = before


def load_module(where: str) -> ModuleType:
    """Load a Python file, or a module on the path or in the working folder; InputError if it cannot be loaded."""
    if where.endswith(".py"):
        path = Path(where)
        found = importlib.util.spec_from_file_location(path.stem, path, loader=_AsItStands(path.stem, where))
        if not path.is_file() or found is None or found.loader is None:
            raise InputError(f"{where}: no such Python file.")
        module = importlib.util.module_from_spec(found)
        try:
            with as_input_error(where), _no_byte_code():
                found.loader.exec_module(module)
        except ModuleNotFoundError as error:
            raise InputError(f"{where}: {error}. Install it, or start safeloc where it can be found.") from error
        return module
    if str(Path.cwd()) not in sys.path:
        sys.path.insert(0, str(Path.cwd()))
    try:
        with as_input_error(where), _no_byte_code():
            return importlib.import_module(where)
    except ModuleNotFoundError as error:
        raise InputError(
            f"cannot import {where!r}: {error}. Give a module on the path, or path/to/file.py:name."
        ) from error


@contextmanager
def as_input_error(where: str) -> Iterator[None]:
    """Raise InputError if a user's file fails: this is wrong input, not a violated property.

    The cause stays attached.
    """
    try:
        yield
    except (SafelocError, ModuleNotFoundError):
        raise
    except (Exception, SystemExit) as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        raise InputError(f"{where} fails: {type(error).__name__}: {error} ({place.filename}:{place.lineno})") from error


def _properties(module: ModuleType, found: Machine | Composition) -> tuple[Property, ...]:
    listed = _listed(module, "properties", _declared(module, "properties", found))
    for number, item in enumerate(listed):
        if not isinstance(item, Property):
            raise InputError(
                f"{module.__name__}.properties holds {_described(item)} at place {number} ({_file(module)}); "
                "expected always(...), never(...), within(...) or reachable(...)."
            )
    return listed


def _declared(module: ModuleType, name: str, found: Machine | Composition) -> object:
    """Return what a user's module declares under this name: its value, or the result of its function of the machine."""
    declared: object = getattr(module, name, ())
    if callable(declared):
        with as_input_error(f"{module.__name__}.{name}"):
            return declared(found)
    return declared


def _listed(module: ModuleType, name: str, declared: object) -> tuple[Any, ...]:
    """Return the list that a user's module declares under this name; InputError if it is no list."""
    if not isinstance(declared, Sequence) or isinstance(declared, (str, bytes)):
        raise InputError(
            f"{module.__name__}.{name} is {_described(declared)} ({_file(module)}); "
            f"expected a list{'' if name == 'pictures' else ', or a function of the machine that returns one'}."
        )
    return tuple(declared)


def _described(item: object) -> str:
    return f"{reprlib.repr(item)} of type {type(item).__name__}"


def _file(module: ModuleType) -> str:
    return str(getattr(module, "__file__", module.__name__))
