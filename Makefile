# `make run`   sets up, runs decks/anvil and draws it        `make test`      sets up, all tests of a normal day
# `make lint`  ruff, lint and format                         `make test-all`  the slow ones too
# `make docs`  the deck reference from the registry          `make clean`     removes what make made
# `make bench-flow`  what the liquid costs by mesh and by wetted share; PART=wet runs that one
# `make bench-bodies`  what bodies in the liquid cost; PART=surface runs that one
# `make bench-interfoam`  the dam break beside OpenFOAM's interFoam, which must be installed
# `make bench-collision`  cost and error of each part of the collision model; PART=search runs that one

PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready

.PHONY: run test test-all lint docs bench-bodies bench-collision bench-flow bench-interfoam clean setup

setup: $(READY)

$(READY): pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[postproc,test]'
	touch $(READY)

run: $(READY)
	$(BIN)/flowgmo run decks/anvil/anvil.nml --overwrite
	$(BIN)/flowgmo-postproc report decks/anvil/anvil.out

test: $(READY)
	$(BIN)/python -m pytest -n 2 -m "not slow"

test-all: $(READY)
	$(BIN)/python -m pytest -n 2

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

docs: $(READY)
	$(BIN)/python -m flowgmo.deck.reference > docs/deck-reference.md

bench-collision: $(READY)
	$(BIN)/python tests/cost/bench_collision.py $(PART)

bench-flow: $(READY)
	$(BIN)/python tests/cost/bench_flow.py $(PART)

bench-interfoam: $(READY)
	$(BIN)/python tests/cost/bench_interfoam.py

bench-bodies: $(READY)
	$(BIN)/python tests/cost/bench_bodies.py $(PART)

clean:
	rm -rf $(VENV) build *.egg-info decks/*/*.out
