# Two commands set everything up on a machine with Python 3.11 or newer, make and a C compiler:
#   make verify   proofs, property tests, replay, report      make test   all ordinary tests
PYTHON ?= python3
BIN := .venv/bin
READY := .venv/ready

.PHONY: verify test test-all lint bench coverage clean

verify: $(READY)
	$(BIN)/safeloc verify --out safeloc-report --jobs 2

test: $(READY)
	$(BIN)/python -m pytest -n 2 -m "not slow"

test-all: $(READY)
	SAFELOC_HYPOTHESIS=deep $(BIN)/python -m pytest -n 2

lint: $(READY)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/pyright

bench: $(READY)
	$(BIN)/python -m benchmarks

coverage: $(READY)
	$(BIN)/python -m pytest -m "not slow" --cov --cov-report=term-missing

clean:
	rm -rf .venv build dist *.egg-info safeloc-report

# Installed as editable, so that an edit in the checkout is seen at once; the wheel is what tests/test_packaging.py tries.
$(READY): pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit("Python 3.11 or newer is needed") if sys.version_info < (3, 11) else None'
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet -e '.[dev,bench]'
	touch $(READY)
