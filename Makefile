# make: install; make run [SCENE=folder]: open the console; make test: every check.
PYTHON ?= python3
SCENE ?=
BIN := .venv/bin
CHECKED := rotrecon app tests scripts

all: .venv/installed

.venv/installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv .venv >/dev/null 2>&1 || (sudo=$$(command -v sudo); $$sudo apt-get update && $$sudo apt-get install -y python3-venv && $(PYTHON) -m venv .venv)
	$(BIN)/pip install --quiet --constraint constraints.txt --editable .
	touch $@

.venv/installed-test: .venv/installed
	$(BIN)/pip install --quiet --constraint constraints.txt --editable '.[test]'
	touch $@

chromium:
	@command -v chromium >/dev/null || (sudo=$$(command -v sudo); $$sudo apt-get update && $$sudo apt-get install -y chromium)

run: .venv/installed
	$(BIN)/rotrecon serve $(SCENE)

test: .venv/installed-test chromium
	$(BIN)/ruff check $(CHECKED)
	$(BIN)/ruff format --check $(CHECKED)
	$(BIN)/pyright
	$(BIN)/pytest

.PHONY: all chromium run test
