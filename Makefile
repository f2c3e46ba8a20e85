# Everything a person runs by hand. CMake does the work; presets are in CMakePresets.json.
JOBS ?= $(shell nproc)
.DEFAULT_GOAL := help
.PHONY: help setup build demo demo-table demo-artemis studio manual test bench format tidy install package package-arm64 clean

help: ## this text
	@sed -n 's/^\([a-z0-9-]*\):.*## /  make \1\t/p' $(MAKEFILE_LIST) | expand -t 22

setup: ## install the Debian packages that are missing
	@tools/setup

build: setup ## build/release/bin/segue, the component libraries and the examples
	@mkdir -p build
	@cmake --preset release > build/release.log 2>&1 || { cat build/release.log; exit 1; }
	@cmake --build --preset release --target product -j $(JOBS)

demo: ## a simulated rover fetches a box: a film, a Gantt chart and the transitions, in out/
	@JOBS=$(JOBS) tools/demo

demo-table: ## it clears a table sequentially and concurrently: a film of both side by side, in out/
	@JOBS=$(JOBS) tools/demo --table

demo-artemis: build ## the four controllers of the Artemis rover, switched online
	@build/release/bin/artemis_demo examples/04_artemis/robot.yaml

studio: build ## the Artemis rover in a browser: its twelve transitions by hand, until Ctrl-C
	@build/release/bin/segue run --stand-in examples/04_artemis/robot.yaml --controller search_explore --studio

manual: ## the manual as HTML with a search and the C++ reference, in build/manual; with pictures of the studio after `make test`
	@tools/setup --manual
	@tools/manual

test: ## what CI runs (tools/test --help: single stages, quick checks before a commit, those of the night)
	@tools/test

bench: setup ## all benchmarks, with their floors in the same run
	@mkdir -p build
	@cmake --preset release > build/release.log 2>&1 || { cat build/release.log; exit 1; }
	@cmake --build --preset release --target benchmarks -j $(JOBS)
	@bench/run

format: ## clang-format over the whole tree
	@git ls-files '*.cpp' '*.hpp' | xargs clang-format-14 -i

tidy: ## clang-tidy over the whole tree
	@tools/tidy

install: build ## install below PREFIX (default /usr/local)
	@cmake --install build/release --prefix $(or $(PREFIX),/usr/local)

package: build ## Debian packages, in build/packages
	@tools/setup --packages
	@tools/package build/release build/packages

package-arm64: ## Debian packages for 64-bit ARM, cross-compiled, in build/packages-arm64
	@tools/setup --arm64
	@tools/arm64_root
	@cmake --preset arm64 > build/arm64.log 2>&1 || { cat build/arm64.log; exit 1; }
	@cmake --build --preset arm64 --target product -j $(JOBS)
	@tools/package build/arm64 build/packages-arm64

clean: ## remove what was built
	@rm -rf build
