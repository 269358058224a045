"""Results that are kept for reports: of the present content of a target alone, one kind apart from the other."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from safeloc.assurance.kept_results import KeptResults
from safeloc.proof.cache.store import Store
from tests.assurance.mutation.shop import loaded


def test_a_result_is_of_its_target_and_kind(tmp_path: Path) -> None:
    """A target with one property less, another kind and another digest of the maker have none."""
    store, (target, _, _) = Store(tmp_path), loaded()
    kind, other, made = (
        KeptResults("one kind"),
        KeptResults("another"),
        KeptResults("one kind", lambda target, _: f"maker of {target.name}"),
    )
    assert kind.kept(store, target) is None
    kind.keep(store, target, {"figure": 3})
    changed = replace(target, properties=target.properties[1:])
    assert kind.kept(store, target) == {"figure": 3}
    assert [one.kept(store, target) for one in (other, made)] == [None, None]
    assert kind.kept(store, changed) is None
    assert kind.of_targets(store, [target, replace(changed, name="changed")]) == {"brake": {"figure": 3}}


def test_the_stamp_moves_with_each_result(tmp_path: Path) -> None:
    """Each result that is kept changes the stamp of its kind, also an equal one; no other stamp moves."""
    store, (target, _, _) = Store(tmp_path), loaded()
    kind, other = KeptResults("one kind"), KeptResults("another")
    stamps = [kind.stamp(store)]
    for data in (1, 2, 2):
        kind.keep(store, target, data)
        stamps.append(kind.stamp(store))
    assert stamps[0] == other.stamp(store) == ""
    assert len(set(stamps)) == 4
