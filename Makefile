# Targets for users and developers. Everything is built in build/; results are in results/.
PRESET  ?= release
OPTIONS ?=
COUNT   ?= 60
PREFIX  ?= /usr/local
PYTHON_BUILD = $(or $(PELLICLE_BUILD),build/python)
PROGRAM  = build/$(PRESET)/pellicle
# one line per finished step on a terminal, only warnings and errors elsewhere
QUIET   := $(shell [ -t 2 ] || echo -- --quiet)

.NOTPARALLEL:
.PHONY: help build program live test check nightly mutate demo bench bench-peers bench-bodies web wasm site machines compilers threads endurance blender reproduction mutants-of-the-papers mutants-of-the-limits python format docs pictures install deb release clean

build: build/$(PRESET)/tests/CTestTestfile.cmake ## build the library, the program and the tests (PRESET=debug, asan, ...)
	@cmake --build build/$(PRESET) $(QUIET)

help: ## print this list
	@sed -n 's/^\([a-z-]*\):[^#]*## /  make \1\t/p' Makefile | expand -t 32

# the program and its libraries, without the tests
program: build/$(PRESET)/build.ninja
	@cmake --build build/$(PRESET) --target pellicle_program $(QUIET)

demo: program ## press an organ; MESH=file presses that mesh (SCALE=0.001: millimetres; UP=y: y is up), SCENE=file runs that scene
	@tools/demo $(PROGRAM) "$(SCENE)" "$(MESH)" "$(SCALE)" "$(UP)"

live: program web ## touch an organ in a browser (needs Node.js and the npm registry once); SCENE=file or MESH=file: yours
	@$(PROGRAM) live "$(or $(SCENE),$(MESH),organ-press)"

test: build ## run the tests, without the parts that take long; PELLICLE_ALL=1 make test runs these too
	@ctest --test-dir build/$(PRESET) --output-on-failure -j 2; status=$$?; tools/test-summary build/$(PRESET) || status=1; exit $$status

check: build/$(PRESET)/tests/CTestTestfile.cmake $(if $(filter web/%,$(NAME)),web) $(if $(filter web/pellicle web/play web/examples,$(NAME)),wasm) ## build and run one test: NAME=tool/grip
	@tools/check build/$(PRESET) "$(NAME)"

nightly: ## run checks that take hours: all tests whole, WebAssembly, pages, 2,000 random scenes, sanitizers, fuzzing, mutations
	@tools/nightly

mutate: need-demo need-dev ## change the library in single places and list changes that no test detects (tools/mutate --help; COUNT=60)
	@tools/mutate --count $(COUNT)

bench: program ## run the benchmarks
	@cmake --build build/$(PRESET) --target benchmarks $(QUIET)
	@$(PROGRAM) bench
	@for bench in build/$(PRESET)/bench/bench_*; do if [ -x "$$bench" ]; then "$$bench"; fi; done

bench-bodies: program need-dev need-bodies ## compare tetrahedra with CalculiX and rigid bodies with Bullet
	@tools/bodies-beside-peers

bench-peers: need-demo need-dev ## compare subdivision with VTK and OpenMesh (needs libvtk9-dev, libopenmesh-dev; MESH=file)
	@cmake --preset release -B build/peers -DPELLICLE_PEERS=ON -DPELLICLE_TESTS=OFF -DPELLICLE_PROGRAM=OFF >/dev/null
	@cmake --build build/peers --target bench_peers $(QUIET)
	@build/peers/bench/peers/bench_peers $(MESH)

web: build/web/report.html ## build the pages of `pellicle report` and `pellicle live` (needs Node.js and the npm registry)

wasm: need-wasm ## build the JavaScript package build/wasm/pellicle, and the page of `pellicle live --html` (needs emscripten and npm)
	@tools/fetch-sources build/sources
	@mkdir -p build/wasm
	@cmake --preset wasm >build/wasm/configure.log 2>&1 || { cat build/wasm/configure.log; exit 1; }
	@cmake --build build/wasm $(QUIET)
	@$(MAKE) --no-print-directory build/web/play.html

python: need-demo need-python ## build the Python package, install it into build/venv and register the Jupyter kernel Pellicle (docs/python.md)
	@test -x build/venv/bin/python || /usr/bin/python3 -m venv --system-site-packages build/venv
	@test -d $(PYTHON_BUILD) || echo "compiling the library for this and older processors: about 5 minutes the first time"
	@PELLICLE_BUILD=$(PYTHON_BUILD) build/venv/bin/pip install --quiet --no-build-isolation --no-index --force-reinstall --no-deps .
	@build/venv/bin/python -c 'import pellicle; print("pellicle", pellicle.__version__, "for", pellicle.kernels(), "in build/venv: build/venv/bin/python")'
	@PYDEVD_DISABLE_FILE_VALIDATION=1 build/venv/bin/python -m ipykernel install --user --name pellicle --display-name Pellicle

format: need-dev ## format the sources
	@git ls-files -co --exclude-standard '*.[ch]' '*.cpp' | xargs clang-format-14 -i

docs: program ## write docs/reference from the tables of the program
	@mkdir -p docs/reference
	@$(PROGRAM) reference >docs/reference/scene.md
	@$(PROGRAM) schema >docs/reference/scene.schema.json

site: need-site program wasm ## build the documentation as web pages in build/site, with scenes that run in the browser (installs MkDocs, Doxygen, emscripten)
	@tools/site $(PROGRAM)

machines: need-machines program ## compile for ARM64 and Windows, run scenes there under qemu and wine and in WebAssembly, and compare the bits
	@tools/machines

blender: program ## write the add-on for Blender to build/blender, and test it where Blender is installed
	@tools/blender-addon $(PROGRAM) build/blender/pellicle-blender.zip

compilers: need-demo need-dev ## compile with GCC and Clang at -O0 to -O3, also for 32-bit floats, run scenes, and compare the bits
	@tools/compilers

threads: program need-dev ## build with the thread sanitizer, run the tests of what runs in threads, and all scenes with four threads (10 minutes)
	@tools/configure tsan -DPELLICLE_TESTS=ON $(OPTIONS)
	@tools/threads $(PROGRAM)

endurance: program ## live use, a study that is killed, and many steps: memory, bits and books in build/endurance.html (LIVE, STUDY: seconds; STEPS)
	@tools/endurance $(PROGRAM) build/endurance.html --live $(or $(LIVE),60) --study $(or $(STUDY),60) --steps $(or $(STEPS),20000)

reproduction: program ## run all experiments of both papers and write docs/reproduction.md (10 minutes of processor time)
	@tools/reproduction $(PROGRAM) results/reproduce docs/reproduction.md papers/lab/numbers.inc

mutants-of-the-papers: need-demo need-dev ## break formulas of both papers on purpose and check that `pellicle reproduce` notices (15 minutes of processor time)
	@tools/mutants-of-the-papers

mutants-of-the-limits: need-demo need-dev ## take out the limits of tools/limits one at a time and check that their tests notice (half an hour)
	@tools/mutate --list tools/limits

pictures: program ## draw docs/pictures from scenes/
	@tools/pictures $(PROGRAM) docs/pictures

install: build/$(PRESET)/build.ninja ## install library, headers and program (PREFIX=/usr/local)
	@cmake --build build/$(PRESET) --target installed $(QUIET)
	@cmake --install build/$(PRESET) --prefix "$(PREFIX)" >build/$(PRESET)/install.log
	@echo "installed into $(PREFIX); build/$(PRESET)/install_manifest.txt lists the files"

deb: need-demo need-python ## build Debian packages in build/deb: pellicle (program), libpellicle-dev, python3-pellicle
	@cmake -S . -B build/deb -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr -DPELLICLE_NATIVE=OFF -DPELLICLE_SHARED=OFF -DPELLICLE_PYTHON=ON -DPELLICLE_TESTS=OFF >/dev/null
	@cmake --build build/deb $(QUIET)
	@cd build/deb && cpack -G DEB >cpack.log || { cat cpack.log; exit 1; }
	@ls build/deb/*.deb

release: program need-python ## build the files of a release in build/dist (wheel, sdist, npm, .deb, sources, page) and try each in a sandbox
	@$(MAKE) --no-print-directory wasm web || echo "without the npm package and the pages" >&2
	@tools/release $(PROGRAM) build/dist
	@tools/try-release build/dist

clean: ## remove build/ (results/ is kept)
	rm -rf build

# Node.js does not have to be Debian's
build/web/report.html: web/node_modules/.package-lock.json web/index.html web/live.html web/vite.config.js $(wildcard web/src/* web/src/live/*)
	@cd web && npm run --silent build

build/web/play.html: web/node_modules/.package-lock.json web/live.html web/vite.config.js $(wildcard web/src/* web/src/live/* build/wasm/pellicle/*)
	@cd web && npm run --silent build-play

web/node_modules/.package-lock.json: web/package-lock.json
	@command -v npm >/dev/null || tools/install-packages web
	@cd web && npm ci --no-audit --no-fund --loglevel=error

# need-GROUP: installs the missing packages of a group of packages.txt
need-%:
	@tools/install-packages $*

build/$(PRESET)/build.ninja: CMakePresets.json | need-demo $(if $(filter release,$(PRESET)),,need-dev)
	@tools/configure $(PRESET) $(OPTIONS)

build/$(PRESET)/tests/CTestTestfile.cmake: CMakePresets.json | need-demo need-dev need-python
	@tools/configure $(PRESET) -DPELLICLE_TESTS=ON $(OPTIONS)
