# The one front for everything.  `make` lists the targets; each first makes .venv where it is missing.

# Which run: the name of a file in configs/, or "shipped" for the data and the model in data_small/.
PRESET ?= small

# Which study: the name of a file in configs/studies.
STUDY ?= learning_curves

# The processes of a pool share the cores already; training sets its own number of threads.
export OMP_NUM_THREADS ?= 1
export OPENBLAS_NUM_THREADS ?= 1
export MKL_NUM_THREADS ?= 1
unexport PYTHONPATH PYTHONHOME

# .venv is as it should be where it has this file.  Its name is made of the content of what set-up
# reads, because the times of files say nothing after a clone or a copy into a container.
SET_UP_FROM := requirements.lock requirements-uv.lock requirements-core.lock requirements-zig.lock \
  pyproject.toml scripts/set_up.sh CMakeLists.txt $(sort $(shell find core -name '*.[ch]pp'))
READY := .venv/ready-$(shell cat $(SET_UP_FROM) | sha256sum | cut -c 1-12)

VENV_PYTHON := .venv/bin/python
LANDSCAPE := .venv/bin/landscape
CONFIG := configs/$(PRESET).toml

SCRIPTS := $(sort $(wildcard paper_figures/figure_*.py))
FIGURES := $(foreach script,$(SCRIPTS),figure-$(word 2,$(subst _, ,$(notdir $(script)))))

COMPILE := .venv/bin/uv pip compile --universal --python-version 3.11 --generate-hashes --no-emit-index-url --quiet

STARTED := $(shell date +%s)

.PHONY: help setup estimate generate train evaluate figures $(FIGURES) bench accuracy odd-wires study
.PHONY: inversion-study claims claims-table report docs test sanitize wasm lint lock clean
.SUFFIXES:
# One after the other: each command uses all cores by itself.
.NOTPARALLEL:

help: ## list the targets
	@echo 'make TARGET [PRESET=small|shipped|smoke|full|paper] [PYTHON=/path/to/python3]'
	@sed -n 's/^\([a-z-]*\):.*## /  \1\t/p' Makefile | expand -t 15
	@echo 'and one figure each: $(FIGURES)'

setup: $(READY) ## make .venv from requirements.lock (a few minutes, once; the others do it themselves)

$(READY):
	@sh scripts/set_up.sh $@

# What is complete stays as it is; the shipped model needs no dataset and no training.  Scripts that only
# draw leave a core idle while they import and write: two at a time.
figures: estimate $(if $(wildcard $(CONFIG)),evaluate) ## dataset, training and every figure of the paper, into build/figures
	@printf '%s\n' $(FIGURES) | xargs -n 1 -P 2 $(MAKE) --no-print-directory PRESET=$(PRESET)
	@echo "make figures: done in $$(($$(date +%s) - $(STARTED))) s (PRESET=$(PRESET)), see build/figures"

estimate: $(READY)
	@$(VENV_PYTHON) paper_figures/estimate.py --preset $(PRESET)

# Figure 1 is the paper's own network whatever the preset; --preset would draw the preset's.
$(FIGURES): figure-%: $(READY)
	$(VENV_PYTHON) $(wildcard paper_figures/figure_$*_*.py) $(if $(filter 1,$*),,--preset $(PRESET))

generate: $(READY) ## simulate the dataset of PRESET
	$(LANDSCAPE) generate --config $(CONFIG)

train: generate ## train the network on it
	$(LANDSCAPE) train --config $(CONFIG)

evaluate: train ## score the network on its test realizations
	$(LANDSCAPE) evaluate --config $(CONFIG)

bench: $(READY) ## time the solvers, table and plot into build/bench (a few minutes)
	$(LANDSCAPE) bench

accuracy: $(READY) ## compare 6000 thermal averages with the integral by brute force
	$(LANDSCAPE) study accuracy
	$(LANDSCAPE) study accuracy_hot
	$(LANDSCAPE) study accuracy_dissipation

odd-wires: $(READY) ## compare odd wires with Kwant and with the integral by brute force (an hour)
	$(LANDSCAPE) study odd_wires

study: $(READY) ## carry out the study STUDY of configs/studies, its table into results (hours; it goes on)
	$(LANDSCAPE) study $(STUDY)

inversion-study: $(READY) ## invert fresh wires, judge errors and error bars, tables into results (hours; it goes on)
	$(LANDSCAPE) study inversions
	$(LANDSCAPE) study starts
	$(LANDSCAPE) study components
	$(LANDSCAPE) study unmodelled
	$(LANDSCAPE) study uniqueness
	$(LANDSCAPE) study smoothers
	$(LANDSCAPE) study calibration

# ONLY=id measures one claim; STORE=1 keeps what has been measured as the value that is stored.
claims: $(READY) ## check the paper's claims: measure again what is quick, table into build/claims.md
	$(VENV_PYTHON) -m disorder_landscape.claims $(addprefix --only ,$(ONLY)) $(if $(STORE),--store)

claims-table: $(READY) ## write the tables of README.md and docs from the stored results
	$(VENV_PYTHON) -m disorder_landscape.claims --write-pages

report: $(READY) ## claims, figures (those in build/figures) and conventions on one page, build/report.html
	$(VENV_PYTHON) report/build.py

docs: $(READY) ## build the documentation from docs, into build/docs/index.html
	.venv/bin/sphinx-build -W --keep-going --quiet -d build/docs-cache docs build/docs
	@echo "make docs: build/docs/index.html"

test: $(READY) ## run the tests
	$(VENV_PYTHON) -m pytest -n 2 --dist worksteal

# Node knows nothing of sanitizers, how long a first result takes says nothing with them, and they reserve
# more memory than any limit on it.  Integrals by brute force are the same conductances over and over.
sanitize: $(READY) ## run the fast tests of the core with bad accesses and overflows caught (gcc's g++)
	@sh scripts/sanitize.sh -n 2 --dist worksteal tests/solver tests/observables --ignore=tests/solver/test_wasm.py \
	  -m 'not slow and not gpu and not brute_force' \
	  --deselect tests/solver/test_processes.py::test_the_first_results_of_a_process_take_no_time \
	  --deselect tests/solver/test_processes.py::test_where_there_are_fewer_threads_than_asked_for_these_do_all

wasm: $(READY) ## compile the core to WebAssembly, for a page without a server: build/wasm/nanowire.wasm
	@sh scripts/wasm.sh build/wasm/nanowire.wasm

lint: $(READY) ## check style, spelling, types, and that layers look down only
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	.venv/bin/codespell
	.venv/bin/mypy
	.venv/bin/lint-imports --no-logo --no-cache

lock: $(READY) ## write the requirements*.lock from pyproject.toml; versions stay where they still fit it
	$(COMPILE) --extra dev -o requirements.lock pyproject.toml
	echo uv | $(COMPILE) -o requirements-uv.lock -
	echo ziglang | $(COMPILE) -o requirements-zig.lock -
	printf '%s\n' cmake nanobind ninja scikit-build-core \
	  | $(COMPILE) --constraints requirements.lock -o requirements-core.lock -

clean: ## remove what runs have made (build), not .venv
	rm -rf build
