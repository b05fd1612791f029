# Two commands on a fresh machine: `make demo` and `make test`. Each sets up .venv from constraints.txt first.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: help demo test check bench clean
help:
	@echo "make demo   plan and walk the two-room scene, pictures in demo/"
	@echo "make test   lint, type-check, run the tests"
	@echo "make check  lint and type-check only"
	@echo "make bench  benchmarks and long campaigns, one table"

$(STAMP): pyproject.toml constraints.txt
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --only-binary :all: --constraint constraints.txt hatchling editables
	$(BIN)/python -m pip install --quiet --only-binary :all: --no-build-isolation --constraint constraints.txt --editable '.[dev]'
	@touch $(STAMP)

check: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

test: check
	$(BIN)/python -m pytest -m "not campaign" -n 2 --dist loadgroup

demo: $(STAMP)
	$(BIN)/surefoot demo -o demo/

bench: $(STAMP)
	$(BIN)/surefoot bench all
	$(BIN)/python -m pytest -m campaign

clean:
	rm -rf $(VENV) demo/ .mypy_cache .ruff_cache .pytest_cache
	find src -name "*.nb[ic]" -delete
