# make demo and make test work on a fresh Debian machine. On the command line may stand:
#   JOBS=2          parallel jobs                     DEMO_STEPS=50   a shorter demo
#   PRESET=ci       warnings are errors               BASE=main       lint by clang-tidy only what changed since
# Other presets have folders of their own: make build-cuda, make build-check.
PRESET ?= release
JOBS ?= $(shell nproc)
BUILD := build/release
export JOBS

# One step after another: two of them may want to install packages; the jobs run inside.
.NOTPARALLEL:
.PHONY: all deps deps-check build demo test bench lint format tidy check-all clean

all: build

deps:
	@bash cmake/deps.sh cmake/packages.txt

deps-check:
	@bash cmake/deps.sh cmake/packages.txt cmake/packages-check.txt

build: deps
	cmake --preset $(PRESET)
	cmake --build $(BUILD) --parallel $(JOBS)

demo: build
	$(BUILD)/tapesim run data/scenes/box_sealing.yaml --out out/demo --video $(if $(DEMO_STEPS),--steps $(DEMO_STEPS))

# Suites named Long... are left to check-all.
CTEST := ctest --output-on-failure --no-tests=error --parallel $(JOBS)
test: build
	$(CTEST) --test-dir $(BUILD) --label-exclude long
	@sed -n '/^case /,/cases in/p' $(BUILD)/Testing/Temporary/LastTest.log

bench: build
	@for program in $$(find $(BUILD)/bench -type f -perm -u+x | sort); do echo "== $$program"; $$program || exit 1; done

lint:
	@bash cmake/lint.sh

format:
	clang-format -i $$(find tape robot cosim apps tests -name '*.[ch]pp' -o -name '*.inl' -o -name '*.cu')

build-%: deps-check
	cmake --preset $*
	cmake --build build/$* --parallel $(JOBS)

tidy: build-check
	@bash cmake/tidy.sh build/check $(BASE)

# Everything that takes too long for each change: the second compiler with the sanitizers, kernels in three shuffled orders, the
# long suites, clang-tidy. Sanitized code runs some fifteen times as long, so suites that simulate rolls for minutes are left out there.
# Hours on two cores; BASE=COMMIT shortens the last part.
check-all: lint test build-check
	$(CTEST) --test-dir build/check --timeout 7200 --label-exclude long --exclude-regex '^(RollOnThings|SettledRoll|ReducedRoll|Studies|ShippedScenes)$$'
	for seed in 1 2 3; do TAPE_SHUFFLE=$$seed $(CTEST) --test-dir $(BUILD) --tests-regex '^(Cases|EachEffect|Stepper|ContactSearch|ReducedRoll)' || exit 1; done
	$(CTEST) --test-dir $(BUILD) --timeout 7200 --label-regex long
	@bash cmake/tidy.sh build/check $(BASE)

clean:
	rm -rf build
