"""Pieces of a report that are kept: an unchanged machine's are taken, those of anything else are made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.language.verdict import Unknown
from safeloc.proof.cache.store import Store
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding
from safeloc.proof.verification.many import verify_targets
from safeloc.proof.verification.one import Plan
from safeloc.report import data, folder, kept_pieces
from safeloc.report.folder import write_folder
from safeloc.report.kept_pieces import KeptPieces, of_results_key, of_target_key, of_texts_key
from safeloc.report.pieces import Piece, made_pieces
from safeloc.target import Target
from tests.shipped import shipped

PLAN = Plan(Limits(depth=4, seconds=10), examples=2, steps=5, seed=1)
KEPT = "3" * 64


def finding(kept_as: str = KEPT) -> Finding:
    """A finding that is in the cache."""
    return Finding("emitter/test/it", "emitter", "test", "it", Unknown("no"), "none", 0.0, kept_as=kept_as)


@pytest.fixture
def emitter() -> Target:
    """A machine that ships."""
    return shipped("emitter")


def refused(*_: object) -> None:
    """Take the place of what makes a piece."""
    raise AssertionError("made again")


def test_a_report_of_kept_pieces_is_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """File by file, with runs, certificates and pictures; and nothing of it is made again, unless it is asked for anew."""
    monkeypatch.setattr(data.time, "strftime", lambda *_: "2026-01-01T00:00:00Z")
    target, store = shipped("travel_direction"), Store(tmp_path / "store")
    found = verify_targets([target], PLAN, jobs=2, on_event=lambda _: None, keep_in=store)["travel_direction"]

    def written(name: str, kept: KeptPieces) -> dict[Path, bytes]:
        place = tmp_path / name
        write_folder(place, found, [target], kept=kept)
        return {path.relative_to(place): path.read_bytes() for path in place.rglob("*") if path.is_file()}

    first = written("first", KeptPieces(store))
    assert {"certificates", "machines", "traces"} <= {name.parts[0] for name in first}
    for name in ("of_target", "pictures_of", "machine_script", "runs_file"):
        monkeypatch.setattr(folder, name, refused)
    monkeypatch.setattr(folder.certificates, "packed_texts", refused)
    assert first == written("again", KeptPieces(store))
    with pytest.raises(AssertionError, match="made again"):
        written("fresh", KeptPieces(store, fresh=True))


@pytest.mark.parametrize(
    "change",
    [
        lambda patch, target: patch.setattr(kept_pieces, "tools_digest", lambda: "other code"),
        lambda patch, target: patch.setattr(kept_pieces, "_modules_digest", lambda _: "other declarations"),
        lambda patch, target: patch.setattr(kept_pieces, "target_digest", lambda _: "another machine"),
    ],
)
def test_another_source_has_another_key(
    change: Callable[[pytest.MonkeyPatch, Target], None], emitter: Target, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the tools, of a module that the declaration leads to, and of the machine as it was made."""
    before = of_target_key(emitter), of_results_key(emitter, [finding()])
    change(monkeypatch, emitter)
    assert not {*before} & {of_target_key(emitter), of_results_key(emitter, [finding()])}


def test_every_module_of_a_machine_counts(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Those of its pictures and its simulation as well, and its comments: a report shows places in files."""
    (tmp_path / "one.py").write_text("a = 1\n")
    monkeypatch.setattr(kept_pieces, "making_modules", lambda *_, left_out: {"one": tmp_path / "one.py"})
    kept_pieces._modules_digest.cache_clear()  # pyright: ignore[reportPrivateUsage]
    before = kept_pieces._modules_digest("emitter")  # pyright: ignore[reportPrivateUsage]
    (tmp_path / "one.py").write_text("# a remark\na = 1\n")
    kept_pieces._modules_digest.cache_clear()  # pyright: ignore[reportPrivateUsage]
    assert before != kept_pieces._modules_digest("emitter")  # pyright: ignore[reportPrivateUsage]
    kept_pieces._modules_digest.cache_clear()  # pyright: ignore[reportPrivateUsage]


def test_other_configurations_results_and_texts_have_other_keys(emitter: Target) -> None:
    """And each kind of piece has one of its own."""
    assert emitter.config is not None
    other = emitter.config.model_copy(update={"place_mm": 7})
    keys = [
        of_target_key(emitter),
        of_target_key(emitter, "script"),
        of_target_key(replace(emitter, config=other)),
        of_target_key(replace(emitter, configuration="slow")),
        of_results_key(emitter, [finding()]),
        of_results_key(emitter, [finding()], "runs"),
        of_results_key(emitter, [finding("4" * 64)]),
        of_texts_key({"a": "b"}),
        of_texts_key({"a": "c"}),
        of_texts_key({"a": "b", "c": ""}),
        of_texts_key({"ab": ""}),
    ]
    assert "" not in keys
    assert len({*keys}) == len(keys)


def test_what_has_no_key(emitter: Target) -> None:
    """A user's machine, one with a configuration file, and results of which not all are in the cache, or not together."""
    own = [
        replace(emitter, spec="lamp.py:machine"),
        replace(emitter, spec="lamp"),
        replace(emitter, config_file=Path("x")),
    ]
    assert [""] * 3 == [of_target_key(one) for one in own] == [of_results_key(one, [finding()]) for one in own]
    apart = [finding(), finding("4" * 64)]
    assert [""] * 3 == [of_results_key(emitter, some) for some in ([], [finding("")], apart)]


def test_a_piece_without_a_key_is_made_each_time(tmp_path: Path) -> None:
    """One with a key is not; texts, bytes and data come back as they were."""
    made, kept = list[str](), KeptPieces(Store(tmp_path))

    def noted(name: str, value: object) -> Callable[[], object]:
        return lambda: (made.append(name), value)[1]

    values = {
        "no key": ("", 1),
        "bytes": ("1" * 64, b"\x00\xff"),
        "text": ("2" * 64, "ä"),
        "data": (KEPT, {"a": [1, None]}),
    }
    pieces = {name: Piece(noted(name, value), key) for name, (key, value) in values.items()}
    for _ in range(2):
        assert {name: value for name, (_, value) in values.items()} == made_pieces(pieces, 1, kept)
    assert [*values, "no key"] == made


def test_what_was_made_by_files_that_changed_meanwhile_is_not_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The code that made it may not be that of its key; and a damaged entry is made again."""
    kept = KeptPieces(Store(tmp_path))
    kept.keep(KEPT, "right")
    assert kept.found(KEPT) == "right"
    [entry] = [path for path in (tmp_path / "kept").rglob("*") if path.is_file()]
    entry.write_bytes(entry.read_bytes()[:-1])
    assert kept.found(KEPT) is None
    monkeypatch.setattr(kept_pieces, "undisturbed", lambda: False)
    kept.keep(KEPT, "right")
    assert kept.found(KEPT) is None
