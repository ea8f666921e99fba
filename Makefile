# The front door. Everything is built under build/; results go to results/.
.PHONY: build test demo bench format docs install packages clean
PRESET ?= release

packages:
	@tools/install-packages

build: packages
	@cmake --preset $(PRESET) >build-configure.log 2>&1 || { cat build-configure.log; exit 1; }; rm -f build-configure.log
	@cmake --build build/$(PRESET)

test: build
	@ctest --test-dir build/$(PRESET) --output-on-failure -j 2

format: packages
	@git ls-files '*.c' '*.h' | xargs clang-format-14 -i

clean:
	rm -rf build
