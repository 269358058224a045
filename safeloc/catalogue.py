"""Find the machine to prove, test, replay or report: a shipped one by name, a user's own by address."""

from __future__ import annotations

import difflib
import gc
import json
import re
import reprlib
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any
from weakref import WeakValueDictionary

from pydantic import BaseModel, ValidationError

from safeloc.errors import InputError, ModelError
from safeloc.language.renamed import FIELDS, TIMES, hint
from safeloc.own_module import as_input_error, load_module, own_target
from safeloc.runtime.outside import read_bytes
from safeloc.runtime.toml_place import line_of
from safeloc.shipped_machines import ENTRIES
from safeloc.shipped_machines.source_kinds import KINDS, SEPARATOR, WITH_SOURCES
from safeloc.target import Entry, Target

NAMED = re.compile(r"(.+?:[A-Za-z_]\w*)(?:\+|$)")
"""One of several joined functions, each given by its file or module."""
LARGEST_CONFIG = 1_000_000
"""Maximum size of a configuration file, in bytes."""

__all__ = ["DEFAULTS", "ENTRIES", "Entry", "Target", "configured", "load_target", "read_config", "with_defaults"]


def load_target(spec: str, config: Path | None = None, *, with_recordings: bool = True) -> Target:
    """Load a shipped machine by name, or a user's own as `package.module:name` or `path/to/file.py:name`.

    A user's name is a Machine, a Composition, or a function that returns one (called without arguments, or with the
    content of the configuration file). Its module may define `properties` and `recordings` (paths from its file), each a list or
    a function of the machine, `simulate`, a function of a seed that returns the steps of a run, `reported`, a Reported that names
    the outputs of the interval, and `pictures`, a list of drawings of its recorded runs. Without `with_recordings`, a recording that a
    user's module names need not be there.
    The target records the requested name (`spec`) and, if its module declares no property, the reason (`unasked`).
    InputError names the requested machine and the existing ones.
    """
    found = replace(_found(spec, config, with_recordings), spec=spec, config_file=config)
    if config is None and ":" not in spec and spec in ENTRIES:  # to ask for a user's own would load all that ship
        _WITH_DEFAULTS[spec] = found
    return found


_WITH_DEFAULTS: WeakValueDictionary[str, Target] = WeakValueDictionary()


def with_defaults(name: str) -> Target:
    """Return a machine that ships, with its defaults: the one that was loaded last, if somebody still has it, else a new one."""
    found = _WITH_DEFAULTS.get(name)
    return load_target(name) if found is None else found


DEFAULTS = "the defaults"
"""Name of the configuration without changes, beside the declared ones."""


def configured(spec: str, names: Sequence[str]) -> Iterator[tuple[str, Target]]:
    """Load a shipped machine in its named configurations, or in all of them (the defaults included) for `all`.

    Each comes with its name, the defaults with the recordings. InputError for a machine that does not ship and for an unknown name.
    """
    if spec not in ENTRIES:
        raise InputError(
            f"{spec}: only shipped machines declare configurations; give one of your own with --config FILE."
        )
    entry = ENTRIES[spec]
    declared = {DEFAULTS: entry.config(), **entry.configurations.named}
    unknown = [name for name in names if name not in (*declared, "all")]
    if unknown:
        raise InputError(f"{spec} has no configuration {unknown[0]!r}; it has all, {', '.join(declared)}.")
    for name, config in declared.items():
        if "all" in names or name in names:
            built = replace(_built(entry, config), spec=spec)
            if name != DEFAULTS:
                built = replace(built, streams=(), configuration=name)  # the streams are of the defaults
            yield name, built


def _found(spec: str, config: Path | None, with_recordings: bool) -> Target:
    kind, plus, sources = spec.partition(SEPARATOR)
    if plus and kind in KINDS:
        return _with_sources(kind, sources, config)
    if ":" in spec:
        return own_target(
            spec, config, None if config is None else _content(config)[0], with_recordings=with_recordings
        )
    if spec not in ENTRIES:
        close = difflib.get_close_matches(spec, ENTRIES, n=1)
        hint = f" Did you mean {close[0]!r}?" if close else ""
        if spec.endswith(".py"):
            hint = f" For a machine in this file give its name as well: {spec}:machine."
        raise InputError(
            f"no machine {spec!r}; there are {', '.join(ENTRIES)}, or package.module:name for your own.{hint}"
        )
    entry = ENTRIES[spec]
    own = read_config(entry.config, config)
    return replace(_made(entry, own, config), other_figures=own != entry.config())


def sources_of(spec: str) -> list[str]:
    """Return the user's functions that stand behind `localizer+` in a requested name; the name itself if there are
    none.
    """
    kind, _, sources = spec.partition(SEPARATOR)
    return NAMED.findall(sources) if kind in KINDS and sources else [spec]


def with_sources(spec: str, sources: Sequence[str]) -> list[str]:
    """Return the names of all targets to be verified of a localizer with these sources.

    They are each source's contract, the localizer with these sources alone, and the localizer with its own as well. InputError
    for another machine.
    """
    if spec != WITH_SOURCES:
        raise InputError(f"--source is for the localizer; {spec!r} takes no source of your own.")
    together = SEPARATOR.join(sources)
    contracts = [f"contract{SEPARATOR}{one}" for one in sources]
    return [*contracts, f"alone{SEPARATOR}{together}", f"{spec}{SEPARATOR}{together}"]


def _with_sources(kind: str, sources: str, config: Path | None) -> Target:
    """Load the localizer with a user's sources, or one source alone: `localizer+FILE.py:NAME`, several joined by `+`."""
    from safeloc.shipped_machines.own_sources import with_own_sources  # loads the localizer

    named = NAMED.findall(sources)
    if SEPARATOR.join(named) != sources or not named:
        raise InputError(f"{sources!r} names no source; give FILE.py:NAME or package.module:NAME, several joined by +.")
    own, makers = read_config(ENTRIES[WITH_SOURCES].config, config), [_maker(one) for one in named]
    with as_input_error(sources):
        return with_own_sources(kind, makers, own)


def _maker(spec: str) -> Callable[..., Any]:
    where, _, name = spec.rpartition(":")
    found = getattr(load_module(where), name, None)
    if not callable(found):
        raise InputError(
            f"{where} has no function {name!r}; a source is a function of a Vehicle that returns a Machine."
        )
    made: Callable[..., Any] = found
    return made


def _made(entry: Entry[Any], config: BaseModel, path: Path | None) -> Target:
    """Make the shipped machine; InputError if each figure of the file is permitted, but the machine cannot be built."""
    if path is None:
        return _built(entry, config)
    try:
        return _built(entry, config)
    except ModelError as error:
        without = list(dict.fromkeys(re.findall(r"transition '([^']+)'", str(error))))
        what = f"transitions that never, or always, fire: {', '.join(without)}" if without else str(error)
        raise InputError(
            f"{path}: machine {entry.name!r} cannot work with these figures ({what}). {_to_correct(config)}"
        ) from error
    except ValidationError as error:
        wrong = "; ".join(_fields(error))
        raise InputError(
            f"{path}: these figures contradict each other in machine {entry.name!r} ({wrong}). {_to_correct(config)}"
        ) from error


def _built(entry: Entry[Any], config: BaseModel) -> Target:
    """Make the machine, with garbage collection off.

    Its many small nodes form no cycles, so a collection would find nothing, and take an eighth of the time.
    """
    looking = gc.isenabled()
    gc.disable()
    try:
        return entry.make(config)
    finally:
        if looking:
            gc.enable()


def _to_correct(config: BaseModel) -> str:
    """Name the figures one of which is wrong: those that differ from the defaults."""
    own = config.model_dump(mode="json", exclude_defaults=True)
    return f"Correct one of: {', '.join(f'{name} = {value}' for name, value in own.items())}."


def read_config(kind: type[BaseModel], path: Path | None) -> BaseModel:
    """Read a configuration from TOML or JSON, or return the defaults without a file; InputError names file and fields, of TOML with lines."""
    if path is None:
        return checked_config(kind, {}, "configuration")
    content, text = _content(path)
    return checked_config(kind, content, path, text)


def checked_config(kind: type[BaseModel], content: Mapping[str, Any], place: object, text: str = "") -> BaseModel:
    """Make a configuration from plain data; InputError names place and fields, with lines if the TOML `text` is given."""
    try:
        return kind.model_validate(_frozen(content))
    except ValidationError as error:
        wrong = [f"  - {field}" for field in _fields(error, kind, text)]
        fields = "1 field is" if len(wrong) == 1 else f"{len(wrong)} fields are"
        raise InputError("\n".join([f"{place}: {fields} wrong:", *wrong])) from error


def _frozen(content: object) -> object:
    """Turn lists into tuples: configurations are strict and immutable, and files have no tuples."""
    if isinstance(content, Mapping):
        return {name: _frozen(value) for name, value in content.items()}
    return tuple(_frozen(value) for value in content) if isinstance(content, list) else content


def _fields(error: ValidationError, kind: type[BaseModel] | None = None, text: str = "") -> list[str]:
    """Describe each wrong field: its name, the error, the value, for an unknown one the nearest field of `kind`, and its line in `text`.

    A figure that contradicts another one has no name before it: the sentence names both.
    """
    return [
        ": ".join(
            filter(None, [".".join(map(str, e["loc"])), f"{_in_words(e)}{_given(e)}{_now(e) or _nearest(e, kind)}"])
        )
        + _line(e, text)
        for e in error.errors()
    ]


def _line(error: Mapping[str, Any], text: str) -> str:
    """Name the line of a wrong field; empty without a text, and of an error that concerns the whole file."""
    return f" (line {line_of(text, error['loc'])})" if text and error["loc"] else ""


def _in_words(error: Mapping[str, Any]) -> str:
    """Return what is wrong with a field of a configuration; `error` is one of pydantic's `ValidationError.errors()`."""
    kind, bound = error["type"], error.get("ctx", {})
    if kind == "missing" and len(error["loc"]) > 1:
        return "has to be given, since a table of the file replaces the default table as a whole"
    if kind in _WORDS:
        return _WORDS[kind].format(**bound)
    return str(error["msg"]).removeprefix("Value error, ")


_WORDS: Mapping[str, str] = {
    **dict.fromkeys(("int_type", "int_from_float", "int_parsing"), "has to be a whole number"),
    "bool_type": "has to be true or false",
    "string_type": "has to be text",
    "extra_forbidden": "there is no such figure",
    "greater_than": "has to be above {gt}",
    "greater_than_equal": "has to be at least {ge}",
    "less_than": "has to be below {lt}",
    "less_than_equal": "has to be at most {le}",
    "literal_error": "has to be {expected}",
    "missing": "has to be given",
    "model_type": "has to be a table of figures",
    "model_attributes_type": "has to be a table of figures",
}
"""The words for pydantic's kinds of errors, with the names of their bounds."""


def _nearest(error: Mapping[str, Any], kind: type[BaseModel] | None) -> str:
    """Name the field that an unknown one may be meant for."""
    if error["type"] != "extra_forbidden" or kind is None:
        return ""
    *way, name = map(str, error["loc"])
    for step in way:
        inner = kind.model_fields[step].annotation if step in kind.model_fields else None
        if not (isinstance(inner, type) and issubclass(inner, BaseModel)):
            return ""
        kind = inner
    return f".{close}" if (close := hint(name, kind.model_fields)) else ""


def _now(error: Mapping[str, Any]) -> str:
    """Name the new field for one of an old version, and the command that converts the file."""
    old = str(error["loc"][-1]) if error["loc"] else ""
    if old not in FIELDS:
        return ""
    return f"; it is {FIELDS[old]} now{', a time instead of cycles' if old in TIMES else ''} (safeloc migrate)"


def _given(error: Mapping[str, Any]) -> str:
    """Return the rejected value in words; empty where the error concerns the whole file."""
    return "" if isinstance(error["input"], dict) else f" (got {reprlib.repr(error['input'])})"


def _content(path: Path) -> tuple[dict[str, Any], str]:
    """Return the table of a configuration file, and its text if it is TOML."""
    if not path.is_file():
        raise InputError(f"{path}: {'a folder, not a configuration file' if path.is_dir() else 'no such file'}.")
    data = read_bytes(path, LARGEST_CONFIG)
    kind = "JSON" if path.suffix == ".json" else "TOML"
    try:
        text = data.decode("utf-8-sig")
        content = json.loads(text) if kind == "JSON" else tomllib.loads(text)
    except RecursionError as error:
        raise InputError(f"{path}: nested too deeply; expected a table of fields.") from error
    except ValueError as error:
        raise InputError(f"{path}: cannot be read as {kind}: {error}") from error
    if not isinstance(content, dict):
        raise InputError(f"{path}: expected a table of fields.")
    return content, "" if kind == "JSON" else text
