"""What a host gives wrongly is refused in words, and a controller is not doubled unseen."""

from __future__ import annotations

import copy
import json
import pickle
from collections.abc import Callable
from functools import cache
from typing import Any

import pytest

from safeloc.errors import InputError, SnapshotError
from safeloc.runtime.embedding import Controller
from safeloc.runtime.embedding.snapshot import sealed
from tests.runtime.embedding.driving import distances, drive, trusting

NAN = float("nan")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Controller("odometry"), r"expected a Program or a Target, got str; load_target\(name\) gives one"),
        (lambda: Controller(None), "expected a Program or a Target, got NoneType"),
        (
            lambda: Controller(trusting(), expected={"front_wheel": NAN}),
            "expected has 'front_wheel': nan; give a channel",
        ),
        (lambda: Controller(trusting(), expected={"front_wheel": "2"}), "expected has 'front_wheel': '2'"),
        (lambda: Controller(trusting(), expected={"front_wheel": True}), "expected has 'front_wheel': True"),
        (lambda: Controller(trusting(), expected={"front_wheel": -1}), "expected has 'front_wheel': -1"),
        (lambda: Controller(trusting(), expected={7: 1}), "expected has 7: 1"),
        (lambda: Controller(trusting(), expected=["front_wheel"]), r"expected is \['front_wheel'\]; give a mapping"),
        (lambda: Controller(trusting(), first=5), "first is 5; give a mapping"),
        (lambda: Controller(trusting(), start_ms=-1), "start_ms is -1; give whole ms"),
        (lambda: Controller(trusting(), period_ms=100.0), "period_ms is 100.0; give whole ms"),
        (lambda: Controller(trusting()).step(None), "expected records .*, got NoneType"),
        (lambda: Controller(trusting()).step(7), "expected records .*, got int"),
        (lambda: Controller(trusting()).step([], lost=None), "lost is None; say it in words"),
        (lambda: Controller(trusting()).step_inputs(None), "inputs is None; give a mapping"),
        (lambda: Controller(trusting()).step_inputs(["front_wheel_mm"]), "inputs is .*; give a mapping"),
        (lambda: Controller(trusting()).step_inputs({}, truth_mm=1.5), "truth_mm is 1.5; give whole mm"),
        (lambda: Controller(trusting()).step_inputs({}, lost=3), "lost is 3; say it in words"),
        (lambda: Controller(trusting()).begin_anew(None), "reason is None; say it in words"),
        (lambda: Controller(trusting()).begin_anew(""), "reason is empty; give the reason"),
        (lambda: Controller(trusting()).begin_anew("x", -5), "start_ms is -5"),
    ],
)
def test_a_wrong_value(make: Callable[[], Any], message: str) -> None:
    """An InputError that says what it is and what to give."""
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize("wrong", [None, 7])
def test_what_is_refused_has_not_happened(wrong: Any) -> None:
    """The controller goes on as if it had not been called."""
    one, other = Controller(trusting()), Controller(trusting())
    with pytest.raises(InputError):
        one.step(wrong)
    with pytest.raises(InputError):
        one.step_inputs(wrong)
    assert one.step(distances(100)) == other.step(distances(100))


@pytest.mark.parametrize("double", [copy.copy, copy.deepcopy, pickle.dumps], ids=["copy", "deepcopy", "pickle"])
def test_a_controller_is_not_doubled(double: Callable[[Any], Any]) -> None:
    """Two that share what they remember would both be wrong: a TypeError, as hosts expect, that says what to do."""
    controller = Controller(trusting())
    for kind in (TypeError, InputError):
        with pytest.raises(
            kind, match=r"^odometry: a controller cannot be (copied|pickled); make a new controller of the same"
        ):
            double(controller)
    assert controller.step(distances(100)).cycle == 1


@cache
def driven() -> dict[str, Any]:
    """The content of a snapshot."""
    controller = Controller(trusting())
    for records in drive(3):
        controller.step(records)
    return dict(json.loads(controller.snapshot()))


OWN = ("config", "deliveries", "done", "halted", "machine", "program", "setting", "start_ms", "state")
"""The fields of a snapshot besides those of every file."""


def test_every_field_is_tried() -> None:
    """Those of a snapshot that was made, and no other one."""
    assert {*OWN} == {*driven()} - {"kind", "version", "checksum"}


@pytest.mark.parametrize("name", OWN)
@pytest.mark.parametrize("wrong", ["missing", None, -1, 1.5, "x", [], [[1, 2]], {"a": NAN}, {"front_wheel": [1]}])
def test_a_snapshot_with_a_wrong_field(name: str, wrong: Any) -> None:
    """Also under a checksum that fits: a SnapshotError, whatever the field, and nothing has changed."""
    body = {key: value for key, value in driven().items() if key not in ("kind", "version", "checksum")}
    if wrong == "missing":
        del body[name]
    else:
        body[name] = wrong
    controller = Controller(trusting())
    before = controller.snapshot()
    if (name, wrong) == ("halted", "x"):
        controller.restore(sealed(body))
        return
    with pytest.raises(SnapshotError):
        controller.restore(sealed(body))
    assert controller.snapshot() == before


def test_a_snapshot_with_an_unknown_field() -> None:
    """It was not written by this version."""
    body = {key: value for key, value in driven().items() if key not in ("kind", "version", "checksum")}
    with pytest.raises(SnapshotError, match="more: Extra inputs are not permitted"):
        Controller(trusting()).restore(sealed({**body, "more": 1}))
