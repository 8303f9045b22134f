# Needs python3 >= 3.11 with venv, and a package index that pip can reach; everything else it makes itself.

PYTHON ?= python3
VENV ?= .venv
CONFIG ?= config/sim.toml
MINUTES ?= 10
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check -qq
PAGE := bentod/dashboard/page
INSTALL := $(PIP) install --constraint constraints.txt --build-constraint constraints.txt --editable ".[web]"

.DEFAULT_GOAL := help
.PHONY: run test check audit fuzz bench faults page screenshots reference clean help

run: $(VENV)/run.stamp ## start the daemon with a simulated arm, and its page (CONFIG=FILE for another)
	@exec $(BIN)/bentod run --dashboard --config $(CONFIG)

test: $(VENV)/test.stamp ## run the tests on all processors (ARGS="-k word" goes to pytest, ARGS="-n 0" uses one)
	@$(BIN)/python -m pytest --numprocesses auto --dist loadfile $(ARGS)

check: $(VENV)/check.stamp ## lint, format, types, layers
	@echo "ruff: lint and format" && $(BIN)/ruff check --quiet && $(BIN)/ruff format --check --quiet
	@echo "mypy: types" && $(BIN)/mypy --no-error-summary
	@echo "import-linter: layers" && $(BIN)/lint-imports --no-logo

audit: $(VENV)/audit.stamp ## fail if an advisory is known for a pinned version (ARGS=--strict: or if nobody answers)
	@$(BIN)/python -m tests.audit.advisories $(ARGS)

fuzz: $(VENV)/fuzz.stamp ## search for input that breaks the socket, guided by coverage (MINUTES=10)
	@$(BIN)/python -m tests.fuzz.campaign --minutes $(MINUTES)

faults: $(VENV)/test.stamp ## break everything around a simulated arm, and renew the tables of what it did
	@$(BIN)/python -m tests.system.campaign README.md docs/faults.md

bench: $(VENV)/test.stamp ## measure: NAME=core prints a table and writes build/bench/core.json
	@test -f "tests/benchmarks/$(NAME).py" || { \
	  echo "make bench NAME=x, where x is one of: $(BENCHMARKS)"; exit 2; }
	@$(BIN)/python -m tests.benchmarks.$(NAME)

reference: $(VENV)/run.stamp ## renew the table of API methods in docs/api.md
	@$(BIN)/python -m bentod.serve.reference docs/api.md

page: $(PAGE)/node_modules/.stamp ## build the page of the dashboard with node and npm (ARGS=--check: only compare)
	@cd $(PAGE) && node build.mjs $(ARGS)

screenshots: $(VENV)/test.stamp ## renew the pictures of the page in docs/images (needs Chromium)
	@$(BIN)/python -m tests.dashboard.screenshots docs/images

BENCHMARKS := $(filter-out __init__ harness test_%,$(notdir $(basename $(wildcard tests/benchmarks/*.py))))

$(PAGE)/node_modules/.stamp: $(PAGE)/package.json $(PAGE)/package-lock.json
	@command -v npm >/dev/null || { echo "no npm (on Debian: apt install nodejs npm); the page as it is needs none"; exit 1; }
	@echo "Installing what the page is built from"
	@cd $(PAGE) && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error
	@touch $@

clean: ## remove what builds, tests and checks leave behind (the environment stays)
	@rm -rf build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	@find bentod drivers sim tests -name __pycache__ -type d -prune -exec rm -rf {} +

help: ## say what can be made
	@sed -n 's/^\([a-z]*\):.*## \(.*\)/  make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 16

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.version_info >= (3, 11) or sys.exit("bentod needs Python 3.11 or later; try make PYTHON=python3.12")'
	@echo "Making an environment in $(VENV)"
	@$(PYTHON) -m venv $(VENV) || { rm -f $@; echo "no venv for $(PYTHON) (on Debian: apt install python3-venv)"; exit 1; }

# An old pip knows neither dependency groups nor build constraints.
$(VENV)/pip.stamp: constraints.txt | $(BIN)/python
	@$(PIP) install --constraint constraints.txt --upgrade pip
	@touch $@

$(VENV)/run.stamp: pyproject.toml constraints.txt hatch_build.py bentod/learn/kernel.c $(VENV)/pip.stamp
	@echo "Installing bentod and what it needs (once; a minute or so)"
	@$(INSTALL)
	@touch $@

$(VENV)/test.stamp: $(VENV)/run.stamp
	@echo "Installing what the tests need"
	@$(INSTALL) --group test
	@touch $@

$(VENV)/check.stamp: $(VENV)/test.stamp
	@echo "Installing the linters"
	@$(INSTALL) --group test --group check
	@touch $@

$(VENV)/audit.stamp: $(VENV)/run.stamp
	@echo "Installing the auditor"
	@$(INSTALL) --group audit
	@touch $@

$(VENV)/fuzz.stamp: $(VENV)/test.stamp
	@echo "Installing the fuzzer"
	@$(INSTALL) --group test --group fuzz
	@touch $@
