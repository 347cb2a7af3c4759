# Each alone on a fresh clone: `make sweep`, `make test`, `make reproduce`.
# They make .venv, install what they need once, and run.

PYTHON ?= python3
ARGS ?=

VENV := .venv
VENV_PYTHON := $(VENV)/bin/python
INSTALLED := $(VENV)/.installed
INSTALLED_TEST := $(VENV)/.installed-test
INSTALLED_BENCH := $(VENV)/.installed-bench
INSTALLED_DOCS := $(VENV)/.installed-docs
SITE := build/site

# Small matrices only: BLAS threads would fight the workers for the cores.
export OPENBLAS_NUM_THREADS := 1

# Every process would compile all modules that it imports; tests start some hundreds.
export PYTHONDONTWRITEBYTECODE :=

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.NOTPARALLEL:
.PHONY: help sweep test test-docs test-faults reproduce bench docs clean

help:
	@echo 'make sweep   run the default study; overrides: make sweep ARGS="grid.replicates=2"'
	@echo 'make test    lint, format, imports, types, tests; one test: make test ARGS="-k store"'
	@echo 'make test-docs   the numbers, commands and examples of README and docs/'
	@echo 'make test-faults   the slow tests: kills, full disks, a cluster, a million cases'
	@echo 'make reproduce   the searches, all runs with 100 records per cell, all figures, the reports;'
	@echo '             ARGS=--check: only say whether results/reference agrees;'
	@echo '             ARGS=--check=numbers: the same of numbers, on the machine that made them'
	@echo 'make bench   speed against goals and peers, into benchmarks/report.md; ARGS=--quick: a look'
	@echo 'make docs    the site, into build/site; ARGS="-D plot_gallery=0": no example is run'
	@echo 'make clean   delete the environment and all caches (never results)'
	@echo 'The Python to use (3.11 or newer): make sweep PYTHON=python3.12'

sweep: $(INSTALLED)
	$(VENV_PYTHON) -m owtsweep sweep $(ARGS)
	@echo 'next: $(VENV)/bin/owtsweep list, or $(VENV)/bin/owtsweep --help'

test: $(INSTALLED_TEST)
	$(VENV_PYTHON) tests/compile_kernels.py & \
	$(VENV_PYTHON) -m ruff check . && \
	$(VENV_PYTHON) -m ruff format --check . && \
	$(VENV)/bin/lint-imports --no-cache --no-logo && \
	$(VENV_PYTHON) -m mypy; status=$$?; wait; exit $$status
	$(VENV_PYTHON) -m pytest --numprocesses 2 --dist worksteal --ignore tests/docs $(ARGS)

test-docs: $(INSTALLED_TEST)
	$(VENV_PYTHON) -m pytest --numprocesses 2 --dist worksteal tests/docs $(ARGS)

# One after the other: some of them look at the clock.
test-faults: $(INSTALLED_TEST)
	$(VENV_PYTHON) -m pytest -m faults $(ARGS)

reproduce: $(INSTALLED)
	$(VENV_PYTHON) -m experiments.reproduce $(ARGS)

bench: $(INSTALLED_BENCH)
	$(VENV_PYTHON) -m benchmarks $(ARGS)

# Nothing is loaded: every picture, script and font is in the site.
docs: $(INSTALLED_DOCS)
	$(VENV_PYTHON) -m sphinx --quiet --fail-on-warning --keep-going -c docs $(ARGS) . $(SITE)
	$(VENV_PYTHON) docs/check_links.py $(SITE)
	@echo 'the site: $(SITE)/docs/index.html'

clean:
	rm -rf $(VENV) build dist docs/gallery examples/gallery/results .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -type d -name __pycache__ -prune -exec rm -rf {} +

# The environment is order-only: its interpreter is a link, whose time says nothing.
$(INSTALLED): pyproject.toml | $(VENV_PYTHON)
	$(VENV_PYTHON) -m pip install --disable-pip-version-check --quiet --editable .
	@touch $@

$(INSTALLED_TEST): pyproject.toml | $(VENV_PYTHON)
	$(VENV_PYTHON) -m pip install --disable-pip-version-check --quiet --editable '.[test]'
	@touch $(INSTALLED) $@

$(INSTALLED_BENCH): pyproject.toml | $(VENV_PYTHON)
	$(VENV_PYTHON) -m pip install --disable-pip-version-check --quiet --editable '.[bench]'
	@touch $(INSTALLED) $@

$(INSTALLED_DOCS): pyproject.toml | $(VENV_PYTHON)
	$(VENV_PYTHON) -m pip install --disable-pip-version-check --quiet --editable '.[docs]'
	@touch $(INSTALLED) $@

$(VENV_PYTHON):
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
		echo '$(PYTHON) is no Python 3.11 or newer; name one: make PYTHON=python3.12' >&2; exit 1; }
	$(PYTHON) -m venv --clear $(VENV)
