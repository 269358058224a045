# Two commands set everything up on a machine with Python 3.11 or newer, make and a C compiler:
#   make verify   proofs, property tests, replay, report      make test   all ordinary tests
# What takes hours, topic by topic (docs/long_tests.md); an ended run goes on where it was, and the last line is `N passed, N failed`:
#   make test-long TOPIC=fuzz [LONG="--seed 2 --jobs 2"]   random machines against an explicit search (tests/fuzz)
#   edits                                                  what is kept of earlier runs never changes a verdict (tests/edits)
#   mutants                                                wrong machines of all machines: each is noticed, or has a written reason (docs/mutation.md)
#   javascript                                             machines as scripts against generated Python, step by step
#   slow                                                   tests that take minutes each (tests/slow_tests.py)
#   readers, oracle, soak                                  readers given anything, mishaps to streams, a day of a fleet
PYTHON ?= python3
BIN := .venv/bin
READY := .venv/ready
# Two processes for two cores. Each begins with a half of the tests, file after file, so that a file's machines are compiled once; who is
# through takes from the other's end. A third one would collect all tests and make its own machines too: as long by the clock, and 6 % more work.
SHARED := -n 2 --dist worksteal
# An ordinary test takes seconds; one that hangs is ended after this time, and where it hung is told.
ENDED := -o faulthandler_timeout=900 -o faulthandler_exit_on_timeout=true
# Of the tests that take more than a second and a half of processor time a sample is ordinary (tests/ordinary.py). WHICH="not slow" are all that take less
# than minutes.
WHICH := ordinary
# Many tests and all proofs start processes: what is compiled once is kept, also where the environment says otherwise.
export PYTHONDONTWRITEBYTECODE :=
# Most modules of the packages are never imported, so pip compiles none: it would take longer than all the rest of the installation.
INSTALL := $(BIN)/python -m pip install --quiet --no-compile

.PHONY: verify test test-all test-long docs lint formatted ruff mypy pyright bench coverage clean

verify: $(READY)
	$(BIN)/safeloc verify --out safeloc-report --jobs 2

test: $(READY)
	$(BIN)/python -m pytest $(SHARED) $(ENDED) -m "$(WHICH)"

test-all: $(READY)
	SAFELOC_HYPOTHESIS=deep $(BIN)/python -m pytest $(SHARED) -m "not slow"

# One line a topic: long-NAME is the command of TOPIC=NAME; what it writes stands in long/.
long-fuzz = -m tests.fuzz --machines 20000 --compositions 1000 --seed 1 --out long/fuzz.jsonl
long-readers = -m tests.fuzz_readers --seconds 600 --out long/readers.jsonl
long-oracle = -m tests.runtime.streams.oracle --lines 10000000 --seed 1 --out long/oracle.jsonl
long-edits = -m tests.edits --edits 200 --seed 1 --out long/edits.jsonl
long-mutants = -m tests.mutants --sample 10000 --seed 1 --out long/mutants.jsonl
long-javascript = -m tests.codegen.long_javascript --steps 1000000 --seed 1 --out long/javascript.jsonl
long-slow = -m tests.slow_tests --jobs 2 --out long/slow.jsonl
long-soak = -m tests.soak --hours-of-fleet 24 --vehicles 200 --wall-minutes 60 --out long/soak.jsonl

test-long: $(READY)
	@test -n "$(long-$(TOPIC))" || { echo "TOPIC is one of: $(patsubst long-%,%,$(filter long-%,$(.VARIABLES)))"; exit 2; }
	@mkdir -p long
	$(BIN)/python $(long-$(TOPIC)) $(LONG)

# The documentation site; a broken link, a page in no list or any other warning fails it. The first page is build/site/index.html.
docs: .venv/docs
	$(BIN)/python -m sphinx --nitpicky --fail-on-warning --keep-going --quiet --jobs 2 -c packaging/site -b html . build/site

lint: pyright mypy formatted ruff

formatted: $(READY)
	$(BIN)/ruff format --check .

ruff: $(READY)
	$(BIN)/ruff check .

mypy pyright: $(READY)
	$(BIN)/$@

bench: $(READY)
	$(BIN)/python -m benchmarks

coverage: $(READY)
	$(BIN)/python -m pytest -m "not slow" --cov --cov-report=term-missing

clean:
	rm -rf .venv build dist *.egg-info safeloc-report

.venv/docs: $(READY)
	$(INSTALL) -e '.[docs]'
	touch $@

# Installed as editable, so that an edit in the checkout is seen at once; the wheel is what tests/test_packaging.py tries.
$(READY): pyproject.toml setup.py
	$(PYTHON) -c 'import sys; sys.exit("Python 3.11 or newer is needed") if sys.version_info < (3, 11) else None'
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(INSTALL) -e '.[dev,bench]'
	touch $(READY)
