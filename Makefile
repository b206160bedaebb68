# make: install; make run [SCENE=folder] [PORT=8090]: open the console; make test: every check.
PYTHON ?= python3
SCENE ?=
PORT =
BIN := .venv/bin
APT := $(shell command -v sudo) apt-get
CHECKED := rotrecon app tests scripts

all: .venv/installed

.venv/installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv .venv >/dev/null 2>&1 || ($(APT) update && $(APT) install -y python3-venv && $(PYTHON) -m venv .venv)
	$(BIN)/pip install --quiet --constraint constraints.txt hatchling editables
	$(BIN)/pip install --quiet --constraint constraints.txt --no-build-isolation --editable .
	$(BIN)/python -c 'import rotrecon.reconstruct'  # its loops are compiled now, not while somebody waits
	touch $@

.venv/installed-test: .venv/installed
	$(BIN)/pip install --quiet --constraint constraints.txt --no-build-isolation --editable '.[test]'
	touch $@

# libatomic1 is what the browser tests' driver needs; Ubuntu calls Chromium chromium-browser
chromium:
	@(command -v chromium || command -v chromium-browser) >/dev/null && /sbin/ldconfig -p | grep -q libatomic.so.1 \
	|| ($(APT) update && ($(APT) install -y chromium libatomic1 || $(APT) install -y chromium-browser libatomic1))

run: .venv/installed
	$(BIN)/rotrecon serve $(SCENE) $(if $(PORT),--port $(PORT))

test: .venv/installed-test chromium
	$(BIN)/ruff check $(CHECKED)
	$(BIN)/ruff format --check $(CHECKED)
	$(BIN)/pyright
	$(BIN)/pytest

.PHONY: all chromium run test
