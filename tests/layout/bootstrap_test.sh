#!/usr/bin/env bash
# bootstrap_test.sh SOURCE_DIR: what ./bootstrap asks CMake for, seen by a stand-in for CMake: `run` builds the
# program alone, `test` builds all, CUDA is built where there is a GPU, and progress is shown. Stand-ins for the system's
# tools tell which packages are there, and which can be had.
set -euo pipefail
source_dir=$1
temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
mkdir -p "$temporary/tools" "$temporary/project/scenes"
cp "$source_dir/bootstrap" "$temporary/project"
touch "$temporary/project/scenes/pile.json"

# The stand-in notes its arguments, and builds a program and a test driver that do nothing.
cat >"$temporary/tools/cmake" <<'END'
#!/usr/bin/env bash
echo "$*" >>"$CALLS"
if [ "$1" = --preset ]; then
  mkdir -p "build/$2" && touch "build/$2/CMakeCache.txt" "build/$2/build.ninja"
else
  echo "[3/7] Building CXX object a.o"
  mkdir -p "$2/bin" && printf '#!/bin/sh\necho "ran $*"\n' >"$2/bin/scree" && chmod +x "$2/bin/scree"
fi
END
printf '#!/bin/sh\nexit 0\n' >"$temporary/tools/ctest"
printf '#!/bin/sh\necho "$GPU_LIST"\n' >"$temporary/tools/nvidia-smi"
cat >"$temporary/tools/dpkg-query" <<'END'
#!/usr/bin/env bash
shift 2
for package; do [[ " $MISSING " == *" $package "* ]] || echo "installed $package:amd64"; done
END
cat >"$temporary/tools/apt-get" <<'END'
#!/usr/bin/env bash
echo "apt-get $*" >>"$CALLS"
for package in $NOT_TO_BE_HAD; do [[ " $* " != *" $package "* ]] || exit 100; done
END
printf '#!/bin/sh\nshift; exec "$@"\n' >"$temporary/tools/sudo"
printf '#!/bin/sh\nexit 1\n' >"$temporary/tools/g++" # no header is there
chmod +x "$temporary"/tools/*
export PATH=$temporary/tools:$PATH CALLS=$temporary/calls MISSING="" NOT_TO_BE_HAD=""
unset SCREE_PRESET

fail() {
  echo "bootstrap test: $*"
  cat "$CALLS" "$temporary/output"
  exit 1
}
bootstrap() { # bootstrap GPU_LIST ARGUMENT...
  rm -rf "$temporary/project/build" "$CALLS"
  GPU_LIST=$1 "$temporary/project/bootstrap" "${@:2}" >"$temporary/output" 2>&1 || fail "exit $?"
}

bootstrap "" run --steps 3
grep -q -- '--preset cpu-release' "$CALLS" || fail "CUDA is built without a GPU"
grep -q -- '--build .*--target scree' "$CALLS" || fail "'run' builds more than the program"
grep -q 'built 3/7' "$temporary/output" || fail "no progress is shown"
grep -q 'ran run .*pile.json --steps 3' "$temporary/output" || fail "the program did not run"
bootstrap "GPU 0: Some Model (UUID: GPU-1)" run
grep -q -- '--preset release' "$CALLS" || fail "CUDA is not built for the GPU"
bootstrap "" test
! grep -q -- '--target' "$CALLS" || fail "'test' does not build all"
SCREE_PRESET=ci bootstrap "" build
grep -q -- '--preset ci' "$CALLS" || fail "SCREE_PRESET is ignored"
! grep -q apt-get "$CALLS" || fail "packages that are there are installed"

MISSING="libpng-dev libopenmpi-dev" bootstrap "" build
grep -q 'apt-get .* install .* libpng-dev libopenmpi-dev' "$CALLS" || fail "missing packages are not installed"
MISSING="libpng-dev libopenmpi-dev" NOT_TO_BE_HAD=libopenmpi-dev bootstrap "" build
grep -q 'apt-get .* install .* libpng-dev$' "$CALLS" || fail "a package that is optional keeps the others away"
grep -q -- '--build' "$CALLS" || fail "nothing is built"
MISSING=libopenmpi-dev NOT_TO_BE_HAD=libopenmpi-dev bootstrap "" build
grep -q 'could not be installed; going on without' "$temporary/output" || fail "what is missing is not told"
grep -q -- '--build' "$CALLS" || fail "nothing is built without MPI"
rm "$CALLS"
MISSING=libopenmpi-dev GPU_LIST="" "$temporary/project/bootstrap" build >"$temporary/output" 2>&1 || fail "exit $?"
! grep -q apt-get "$CALLS" || fail "an optional package is asked for again after configuring"
