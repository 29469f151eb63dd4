# make demo: set up, stream, analyse, log, and draw a picture
# make live: set up, stream, analyse, and show it all on a page in the browser
# make quick: set up, check, and test what needs no ROS and no long run, in a minute
# make test: set up, check and test everything
# make docs: the documentation as a site, with the Python API
# make fuzz, make mutants, make soak: long runs; see CONTRIBUTING.md

PYTHON ?= python3
VENV := .venv
OLDEST := .venv-oldest

# Whatever else is sourced in this shell would shadow the private environment.
unexport PYTHONPATH PYTHONHOME AMENT_PREFIX_PATH RMW_IMPLEMENTATION LD_LIBRARY_PATH
unexport _ROS_WHEELS_BOOTSTRAP_COMPLETE

# Many tests wait for a stream: two at a time fill two cores. The tests of a file share what takes
# long to set up, so they stay on one core.
PYTEST := -m pytest --numprocesses 2 --dist loadfile --no-loadscope-reorder

.PHONY: demo live quick test test-oldest fuzz mutants soak validate pictures docs readme
.DEFAULT_GOAL := demo

demo: $(VENV)/ros
	@$(VENV)/bin/python -m demo

live: $(VENV)/live
	@$(VENV)/bin/python -m gear_dynamics rig --dashboard --no-log

# The rooms that compile little; ROS, chaos and long runs are left to `make test`.
QUICK := test/parameters test/machine test/wire test/signal test/recordings test/model \
  test/simulation test/package/test_arrows.py test/package/test_file_sizes.py test/package/test_doctests.py

quick: $(VENV)/test
	@$(VENV)/bin/ruff check --quiet
	@$(VENV)/bin/ruff format --quiet --check
	@$(VENV)/bin/mypy
	@$(VENV)/bin/python $(PYTEST) --quiet -m 'not slow' $(wildcard $(QUICK))

test: $(VENV)/test
	@$(VENV)/bin/ruff check --quiet
	@$(VENV)/bin/ruff format --quiet --check
	@$(VENV)/bin/mypy
	@$(VENV)/bin/python $(PYTEST) --cov --cov-report=term:skip-covered

# Random damage to logs, messages, texts, commands and streams: EXAMPLES of each kind.
EXAMPLES ?= 20000

fuzz: $(VENV)/test
	@FUZZ_EXAMPLES=$(EXAMPLES) $(VENV)/bin/python -m pytest --quiet --timeout=0 test/fuzz

# A random sample of defects, put into the code one at a time: do the tests notice?
COUNT ?= 200
MINUTES ?= 0
ROOMS ?= model,integrator,dynamics,signal,monitoring,study

mutants: $(VENV)/test
	@$(VENV)/bin/python tools/mutants.py --count $(COUNT) --minutes $(MINUTES) --rooms $(ROOMS)

# Hours of streaming, logging and replay, with kills, stops and a disk that fills.
HOURS ?= 2

soak: $(VENV)/ros
	@$(VENV)/bin/python tools/soak.py --hours $(HOURS)

# Model time under a random walk of speed and load: is the monitor silent, and does it name faults?
VALIDATED ?= 60

validate: $(VENV)/ros
	@$(VENV)/bin/python benchmarks/monitor_validation.py --minutes $(VALIDATED)

# What Ubuntu 24.04 ships, with the tests that need no ROS.
test-oldest: $(OLDEST)/test
	@$(OLDEST)/bin/python $(PYTEST) --quiet

$(VENV)/ros: setup.py package.xml
	@$(PYTHON) tools/environment.py $(VENV) -e '.[ros]'
	@touch $@

$(VENV)/live: setup.py package.xml
	@$(PYTHON) tools/environment.py $(VENV) -e '.[ros,live]'
	@touch $(VENV)/ros $@

$(VENV)/test: setup.py package.xml
	@$(PYTHON) tools/environment.py $(VENV) -e '.[ros,test]'
	@touch $(VENV)/ros $(VENV)/live $@

$(VENV)/docs: setup.py package.xml
	@$(PYTHON) tools/environment.py $(VENV) -e '.[ros,docs]'
	@touch $@

$(OLDEST)/test: setup.py package.xml
	@$(PYTHON) tools/environment.py $(OLDEST) -e . 'numpy==1.26.*' 'scipy==1.11.*' \
	  'numba==0.58.*' 'matplotlib==3.6.*' pytest pytest-timeout pytest-xdist hypothesis mcap-ros2-support
	@touch $@

# The pictures of the live page in docs/, taken from the real one in headless Chromium.
pictures: $(VENV)/test
	@PAGE_PICTURES=docs $(VENV)/bin/python -m pytest --quiet test/web/test_page.py

# The documentation as a site in build/site, with the Python API.
docs: $(VENV)/docs
	@$(VENV)/bin/python -m mkdocs build --strict --quiet
	@echo build/site/index.html

# What README.md takes from the code.
readme: $(VENV)/ros
	@$(VENV)/bin/python tools/readme.py
