"""pytest plugin: proofs, property tests and recordings of your machines as ordinary test items (docs/howto/pytest.md).

    [tool.pytest.ini_options]
    safeloc_machine = ["door.py:machine"]

Each lemma, property and recording is an item; `-k`, `--durations` and `-x` work as for other tests. A failure prints the run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property, partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from safeloc.proof.provers.limits import Limits
    from safeloc.proof.results import Finding
    from safeloc.proof.verification.one import Work
    from safeloc.target import Target

_INI = "safeloc_machine"
_MOST_STEPS = 30
"""Steps of a run that a failure prints."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the list of machines and the limits."""
    parser.addini(_INI, "machines to verify: file.py:name or package.module:name, one a line", type="linelist")
    group = parser.getgroup("safeloc")
    group.addoption("--safeloc-seconds", type=float, default=30.0, help="limit of effort for each property (30)")
    group.addoption("--safeloc-examples", type=int, default=60, help="runs of the property tests (60)")
    group.addoption("--safeloc-jobs", type=int, default=2, help="processes that prove (2)")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect the machines that the file declares, if the list names some."""
    named = [address for address in parent.config.getini(_INI) if _file_of(address, parent.config) == file_path]
    return _Machines.of(parent, file_path, named) if named else None


def pytest_collection_finish(session: pytest.Session) -> None:
    """Refuse a machine of the list that was not collected, unless the command names what to collect. UsageError."""
    config = session.config
    chosen = (
        config.args_source is pytest.Config.ArgsSource.ARGS
        or config.getoption("keyword")
        or config.getoption("markexpr")
    )
    if chosen or session.testsfailed:
        return
    collected = {item.machine.address for item in session.items if isinstance(item, _Claim)}
    missing = [address for address in config.getini(_INI) if address not in collected]
    if missing:
        raise pytest.UsageError(
            f"{_INI}: {missing[0]} is in no folder that pytest looks in; add the folder of its file to `testpaths`."
        )


def _file_of(address: str, config: pytest.Config) -> Path:
    """Return the file of a machine. UsageError for one that does not exist."""
    place, _, name = address.partition(":")
    found = config.rootpath / place if place.endswith(".py") else _module_file(place)
    if not name or found is None or not found.is_file():
        raise pytest.UsageError(
            f"{_INI}: {address!r}: no such file or module; write file.py:name or package.module:name."
        )
    return found.resolve()


def _module_file(name: str) -> Path | None:
    try:
        spec = find_spec(name)
    except (ImportError, ValueError):
        return None
    return None if spec is None or spec.origin is None else Path(spec.origin)


class _Machines(pytest.File):
    """The machines of one file."""

    addresses: Sequence[str]

    @classmethod
    def of(cls, parent: pytest.Collector, path: Path, addresses: Sequence[str]) -> _Machines:
        made: _Machines = cls.from_parent(parent, path=path)
        made.addresses = addresses
        return made

    def collect(self) -> Iterator[pytest.Collector]:
        """Yield a collector for each machine."""
        for address in self.addresses:
            yield _Machine.of(self, address)


class _Machine(pytest.Collector):
    """One machine: it is loaded once, and what several items need is worked out once."""

    address: str

    @classmethod
    def of(cls, parent: pytest.Collector, address: str) -> _Machine:
        made: _Machine = cls.from_parent(parent, name=address.partition(":")[2])
        made.address = address
        return made

    def collect(self) -> Iterator[pytest.Item]:
        """Yield an item for each lemma and property, the obligations, each property test and each recording."""
        target = self.target
        names = [prop.name for prop in target.properties]
        for name in target.system.lemmas:
            yield self._item(f"lemma: {name}", partial(self._lemma, name))
        if self._contracts:
            yield self._item("contracts", self._contracts_kept)
        for name in names:
            yield self._item(f"proof: {name}", partial(self._proved, [name]))
        yield self._item("obligations", self._obligations)
        for name in names:
            yield self._item(f"test: {name}", partial(self._test, name))
        for path in target.streams:
            yield self._item(f"recording: {path.name}", partial(self._replayed, path))

    def _item(self, name: str, ask: Callable[[], Sequence[Finding]]) -> _Claim:
        made: _Claim = _Claim.from_parent(self, name=name)
        made.machine, made.ask = self, ask
        return made

    @cached_property
    def target(self) -> Target:
        """The machine with its properties and recordings. CollectError for one that cannot be loaded."""
        from safeloc.catalogue import load_target
        from safeloc.errors import SafelocError

        place, _, name = self.address.partition(":")
        try:
            return load_target(f"{self.config.rootpath / place}:{name}" if place.endswith(".py") else self.address)
        except SafelocError as error:
            raise self.CollectError(str(error)) from error

    def _proved(self, names: Sequence[str]) -> list[Finding]:
        """Prove the properties of these names, and no other; and that the assumption can be kept, without which a proof is empty."""
        from safeloc.proof.cache.store import Store, usual_folder
        from safeloc.proof.verification.calls import prove_target

        store = Store(usual_folder())
        jobs = self._option("jobs")
        found = prove_target(
            self.target, only=names, with_assumption=False, limits=self._limits, jobs=jobs, store=store
        )
        return [*(one for one in found if one.kind == "property"), *self._assumption] if names else found

    def _lemma(self, name: str) -> list[Finding]:
        return _of(self._lemmas, name)

    def _contracts_kept(self) -> list[Finding]:
        return [one for name in self._contracts for one in _of(self._lemmas, name)]

    def _obligations(self) -> list[Finding]:
        return self._obliged

    def _test(self, name: str) -> list[Finding]:
        return _of(self._tested, name)

    @cached_property
    def _lemmas(self) -> list[Finding]:
        """The lemmas and contracts, which are proved together."""
        return self._proved([])

    @cached_property
    def _obliged(self) -> list[Finding]:
        """The obligations that every machine has: ranges, overflow, transitions that occur, an assumption that can be kept."""
        return self._work.obliged(self._limits)

    @cached_property
    def _assumption(self) -> list[Finding]:
        """The obligations of the assumption, which every proof needs."""
        return self._work.assumption_kept(self._limits)

    @cached_property
    def _tested(self) -> list[Finding]:
        """The property tests, which share their runs."""
        from safeloc.proof.verification.one import Plan

        plan = Plan(self._limits, examples=self._option("examples"), steps=60, seed=0)
        return self._work.tested(plan, self._obliged)

    def _replayed(self, path: Path) -> list[Finding]:
        """All properties on a recording."""
        from safeloc.proof.verification.replay import replay_stream

        return replay_stream(self.target, path)[1]

    @cached_property
    def _contracts(self) -> list[str]:
        """The names of what the machines of a composition owe each other."""
        from safeloc.proof.provers.inherited import contracts

        return [str(fact) for fact in contracts(self.target.system)]

    @property
    def _limits(self) -> Limits:
        from safeloc.proof.provers.limits import Limits

        return Limits(seconds=self._option("seconds"))

    @property
    def _work(self) -> Work:
        from safeloc.proof.verification.one import Work

        return Work(self.target, self._option("jobs"), lambda *_: None, lambda _: None)

    def _option(self, name: str) -> Any:
        return self.config.getoption(f"safeloc_{name}")


class _NotShown(Exception):
    """Some findings are neither proved nor held."""


class _Claim(pytest.Item):
    """One claim; it passes if all its findings are proved or held."""

    machine: _Machine
    ask: Callable[[], Sequence[Finding]]

    def runtest(self) -> None:
        """Decide the claim; raise the text of what does not hold."""
        from safeloc.language.verdict import word

        found = self.ask()
        wrong = [one for one in found if word(one.result) not in ("proved", "held")]
        if wrong or not found:
            raise _NotShown("\n\n".join(map(_text, wrong)) or f"nothing was found about {self.name!r}")

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Return what does not hold, without the Python stack; of any other error the usual text."""
        if isinstance(excinfo.value, _NotShown):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Return file and name for the heading of a failure."""
        return self.path, None, f"{self.machine.name}: {self.name}"


def _of(findings: Iterable[Finding], name: str) -> list[Finding]:
    return [one for one in findings if one.id.split("/", 2)[2] == name]


def _text(finding: Finding) -> str:
    """Return verdict, reason and run of a finding."""
    from safeloc.language.verdict import word

    result = finding.result
    trace, reason = getattr(result, "trace", None), getattr(result, "reason", "")
    lines = [f"{word(result)}: {finding.statement}", reason, "" if trace is None else trace.table(_MOST_STEPS)]
    return "\n".join(line for line in lines if line)
