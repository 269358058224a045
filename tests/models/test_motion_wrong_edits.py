"""Wrong edits of the error that motion adds, each of which a proof must notice: what its users are owed is not kept any more."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import pytest

from safeloc.language.expr import Bool, Num, as_num, ite, minimum
from safeloc.language.units import NM
from safeloc.models.localizer import LocalizerConfig, compose_machines
from safeloc.models.motion.unit_check import UnitCheck
from safeloc.models.vocabulary.odometer import Odometer
from safeloc.proof.provers.implication import Refuted
from safeloc.proof.provers.proved_base import Base, base
from tests.models.test_motion import one_user

BEYOND = vars(UnitCheck)["beyond"].func
Edit = Callable[[pytest.MonkeyPatch], None]


def _term(kind: type, name: str, wrong: Callable[..., Num | Bool]) -> Edit:
    return lambda patch: patch.setattr(kind, name, property(wrong))


def _standing_up_to_a_metre(check: UnitCheck) -> Bool:
    step = check.unit.measured.value
    return check.checked & check.odometer.measured.value.eq(0) & (step <= 1_000) & (step >= -1_000)


def _standing_by_the_wheel_alone(check: UnitCheck) -> Bool:
    return check.checked & check.odometer.measured.value.eq(0)


def _standing_by_the_radar_alone(check: UnitCheck) -> Bool:
    return check.checked & (check.unit.measured.value <= 55) & (check.unit.measured.value >= -55)


def _half_blind(unit: Odometer) -> Num:
    return ite(unit.admitted, unit.most_error, as_num(unit.limits.blind_nm // 2, NM))


def _stood_before_the_silence(check: UnitCheck) -> Bool:
    still = (check.unit.last <= 55) & (check.unit.last >= -55)
    return check.odometer.last.eq(0) & still


def _capped(check: UnitCheck) -> Num:
    return minimum(BEYOND(check), as_num(100_000_000, NM))


EDITS: Mapping[str, Edit] = {
    "standing is believed up to one metre a cycle": _term(UnitCheck, "standing", _standing_up_to_a_metre),
    "standing is believed of the wheel alone": _term(UnitCheck, "standing", _standing_by_the_wheel_alone),
    "standing is believed of the radar alone": _term(UnitCheck, "standing", _standing_by_the_radar_alone),
    "the run to the next pulse is never added": _term(UnitCheck, "_uncounted", lambda check: as_num(0, NM)),
    "the run to the next pulse is not added after a silence": _term(UnitCheck, "stood", _stood_before_the_silence),
    "nothing is added beyond the law": _term(UnitCheck, "beyond", lambda check: as_num(0, NM)),
    "no more than 0.1 m a cycle is added": _term(UnitCheck, "beyond", _capped),
    "silence adds half the top speed": _term(Odometer, "growth", _half_blind),
    "what does not come back is forgotten": _term(UnitCheck, "_settled", lambda check: as_num(0, NM)),
}


def owed(patch: pytest.MonkeyPatch, edit: Edit | None) -> Base:
    """What is known of motion and balises after the edit."""
    if edit is not None:
        edit(patch)
    return base(one_user(compose_machines(LocalizerConfig(sources=("balise",))), {}), seconds=120)


QUICK = (
    "the run to the next pulse is never added",
    "the run to the next pulse is not added after a silence",
    "no more than 0.1 m a cycle is added",
    "silence adds half the top speed",
)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in EDITS]
)
def test_a_wrong_edit_is_noticed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The contract of the balise machine no longer holds, or a fact of motion falls."""
    refuted = owed(monkeypatch, EDITS[name]).refuted
    assert [str(fact) for fact, why in refuted.items() if isinstance(why, Refuted)]


def test_without_an_edit_all_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """The machine as it is keeps what the edits break."""
    assert owed(monkeypatch, None).refuted == {}
