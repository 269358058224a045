"""Renamed and unknown names: an old keyword, variable or output is refused with the new one, an unknown one with the nearest."""

from __future__ import annotations

import difflib
import inspect
import re
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import wraps
from typing import Any, TypeVar, cast

from safeloc.errors import SafelocError, declared_at

_Declaring = TypeVar("_Declaring", bound=Callable[..., Any])

_SIDES = {"over": "margin_above", "under": "margin_below"}
"""Former and present words for the sides of an interval: `over` was ETCS's under-reading, `under` its over-reading amount."""
_VARIABLES = {
    "step_mm": "distance_mm",
    "step_more_nm": "distance_more_nm",
    "step_um": "true_cycle_distance_um",
    "true_step_nm": "true_cycle_distance_nm",
    "true_step_to_axle_nm": "true_distance_to_axle_nm",
    "band_last_told": "last_band",
    "charged_accuracy_mm": "added_accuracy_mm",
    "distance_told": "distance_reported",
    "heard_high_nm": "last_fix_high_nm",
    "heard_low_nm": "last_fix_low_nm",
    "judged": "last_verdict",
    "kept_axles": "stored_axles",
    "kept_length_high_mm": "stored_length_high_mm",
    "kept_length_low_mm": "stored_length_low_mm",
    "national_accuracy_kept_mm": "national_accuracy_stored_mm",
    "national_accuracy_told_mm": "national_accuracy_sent_mm",
    "reflector_told": "reflector_place_known",
    "rests_on": "evidence",
    "rests_on_age_cycles": "evidence_age_cycles",
    "run_since_whole_um": "run_since_complete_um",
    "run_unheard_nm": "run_since_amplitude_nm",
    "search_told": "search_place_known",
    "told_far_mm": "far_edge_on_map_mm",
    "told_long": "long_on_map",
    "told_more_nm": "reported_more_nm",
    "told_reflector_clear_mm": "announced_reflector_clear_mm",
    "told_reflector_mm": "announced_reflector_mm",
    "told_reflector_model": "announced_reflector_model",
    "told_run_error_nm": "measured_run_error_nm",
    "told_unheard_nm": "possible_run_since_amplitude_nm",
    "told_with": "trust",
    "unheard_cycles": "unreported_cycles",
    "untold_for_cycles": "since_confirmed_cycles",
    "whole_run_measured": "complete_run_measured",
}
"""Former and present names of variables and of fields of records, without the name of a machine in front."""
_OUTPUTS = {"told": "reported", "heard": "verdict", "foreign_heard": "foreign_pattern"}
"""Former and present outputs that are no variables: what a stream calls so is something else."""
_ENDINGS = (
    (re.compile(r"_judged(?=$|_for_next$)"), "_last_verdict"),
    (re.compile(r"_heard_mm$"), "_last_delivered_mm"),
)
"""Former and present endings of variables: the verdict on a sensor's last measurement, and the last distance that it delivered."""
FIELDS = {
    "mute_limit_cycles": "mute_ms",
    "integrity_limit_cycles": "integrity_wait_ms",
    "max_step_mm": "max_cycle_distance_mm",
}
"""Former and present fields of configurations."""
TIMES = frozenset({"mute_limit_cycles", "integrity_limit_cycles"})
"""Former fields that counted cycles; the present ones are times in ms."""
_PARTED = {
    "fix_protection_mm": ("fix_dilution_permille", "fix_further_mm"),
    "fix_speed_protection_um_s": ("fix_speed_dilution_permille", "fix_speed_further_um_s"),
}
"""Former inputs that two inputs have replaced, since the machine now adds the remaining error itself.

The former value determines neither of the two.
"""
_MOVED = {
    "reflector.next_position_mm": "line.next_position_mm",
    "reflector.next_reference_mm": "line.next_reference_mm",
    "verification.record_axles": "entry.record_axles",
    "verification.record_sound": "entry.record_sound",
}
"""Former and present inputs of compositions in which another machine has them now."""
_WIRED = (
    (re.compile(r"reflector\.(balise.*|route_contradicted)"), "the balise machine"),
    (re.compile(r"area\.counters_(healthy|clear)"), "axle_section"),
    (re.compile(r"verification\.associated"), "train_order"),
    (re.compile(r"taking\.record_place_(low|high)_mm"), "the giving area"),
)
"""Former inputs of compositions that another machine gives now, and which."""
_SIDE = re.compile(rf"(?<![A-Za-z])({'|'.join(_SIDES)})(?=_(?:mm|nm)$)")


def name_now(name: str) -> str:
    """Return the present name of a variable, output or field of a record: `fibre_margin_above_mm` for `fibre_over_mm`."""
    machine, dot, bare = name.rpartition(".")
    if bare in _VARIABLES:
        return machine + dot + _VARIABLES[bare]
    for ending, new in _ENDINGS:
        name = ending.sub(new, name)
    return _SIDE.sub(lambda found: _SIDES[found[1]], name)


def renamed(names: Iterable[str], known: Collection[str]) -> str:
    """Return a text to append, `; 'over_mm' is now 'margin_above_mm'`, for the former names among `names`; "" if none."""
    former = [name for name in sorted(names) if name not in known]
    pairs = ((name, _MOVED.get(name, _output_now(name_now(name)))) for name in former)
    one_for_one = "".join(f"; {name!r} is now {new!r}" for name, new in pairs if new in known)
    replaced = ((name, parts) for name in former if (parts := parted(name)) and parts[0] in known)
    machines = {name.partition(".")[0] for name in known if "." in name}
    gone = ((name, wired_from(name)) for name in former if name.partition(".")[0] in machines)
    return (
        one_for_one
        + "".join(f"; {name!r} is replaced by {' and '.join(map(repr, parts))}" for name, parts in replaced)
        + "".join(
            f"; {name!r} is no input any more, {giver} gives it (docs/migrating.md)" for name, giver in gone if giver
        )
    )


def wired_from(name: str) -> str:
    """Return which machine of a composition gives now what was an input of this name; "" for any other name."""
    return next((giver for former, giver in _WIRED if former.fullmatch(name)), "")


def _output_now(name: str) -> str:
    machine, dot, bare = name.rpartition(".")
    return machine + dot + _OUTPUTS.get(bare, bare)


def parted(name: str) -> tuple[str, ...]:
    """Return the inputs that have replaced a former one; an empty tuple for any other name."""
    machine, dot, bare = name.rpartition(".")
    return tuple(machine + dot + part for part in _PARTED.get(bare, ()))


def hint(name: str, known: Collection[str]) -> str:
    """Return a sentence to append that suggests the nearest known name; "" if no name is near."""
    new_name = renamed([name], known)
    if new_name:
        return f" {new_name.removeprefix('; ')}."
    close = difflib.get_close_matches(name, known, n=1)
    return f" Did you mean {close[0]!r}?" if close else ""


def check_keywords(error: type[SafelocError], former: Mapping[str, str]) -> Callable[[_Declaring], _Declaring]:
    """Make a function or class raise `error`, with file and line, for a keyword that it does not take.

    For an old keyword, a key of `former`, the message gives the present one; for any other it lists the keywords that are
    taken, and suggests the nearest. Missing arguments stay Python's own TypeError.
    """

    def checking(declaring: _Declaring) -> _Declaring:
        made: Any = declaring
        name = made.__name__
        if isinstance(declaring, type):
            made.__init__ = _checked(made.__init__, name, error, former)
        else:
            made = _checked(made, name, error, former)
        return cast("_Declaring", made)

    return checking


def _remedy(old: str, new: str) -> str:
    """Return the text to write instead: another keyword, or a complete argument."""
    if "=" in new:
        return f"there is no keyword {old!r} any more; write {new}."
    return f"the keyword {old!r} is now {new!r}; write {new}=."


def _checked(call: Any, name: str, error: type[SafelocError], former: Mapping[str, str]) -> Any:
    taken = [key for key in inspect.signature(call).parameters if key not in ("self", "src")]

    @wraps(call)
    def checked(*values: Any, **named: Any) -> Any:
        for old, new in former.items():
            if old in named:
                raise error(f"{declared_at()}: {name}: {_remedy(old, new)}")
        unknown = next((key for key in named if key not in (*taken, "src")), None)
        if unknown is not None:
            listed = ", ".join(taken)
            raise error(f"{declared_at()}: {name} takes no {unknown!r}; it takes {listed}.{hint(unknown, taken)}")
        return call(*values, **named)

    return checked
