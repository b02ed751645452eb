#!/usr/bin/env bash
# scripts_test.sh SOURCE_DIR: tracked files that begin with #! can be started as the documents say, and scripts of experiments
# find the programs of the newest build, or say in one line what to pass.
set -euo pipefail
source_dir=$1
temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
fail() { echo "$*"; exit 1; }

cd "$source_dir"
begins_with() { # begins_with '#!': those of the files on standard input
  xargs -0 awk -v start="$1" 'FNR == 1 { if (index($0, start) == 1) print FILENAME; nextfile }'
}
# The bit as git has it, which is what a clone gets; a source folder without git has the files alone.
if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
  scripts=$(git ls-files -z -- ':!*.hdf5' | begins_with '#!')
  wrong=$(git ls-files -s -- $scripts | grep -v '^100755 ' | cut -f 2 || true)
else
  scripts=$(find bench docs scenes tests bootstrap -type f ! -name '*.hdf5' -print0 | begins_with '#!')
  wrong=$(find $scripts ! -perm -100)
fi
[ "$(wc -w <<<"$scripts")" -gt 10 ] || fail "few scripts were found: $scripts"
[ -z "$wrong" ] || fail "not executable, though they begin with #!:" $wrong

mkdir "$temporary/bench"
cp bench/*.py "$temporary/bench"
run() { # run SCRIPT ARGUMENTS...: its exit code and what it says
  code=0
  (cd "$temporary" && "bench/$1" "${@:2}") >"$temporary/said" 2>&1 || code=$?
}
expect_line() { # expect_line TEXT: the script ended with this one line
  [ "$code" = 1 ] && [ "$(wc -l <"$temporary/said")" = 1 ] && grep -qF -- "$1" "$temporary/said" ||
    fail "exit code $code, expected 1 and: $1, got: $(cat "$temporary/said")"
}
run comparison.py run --out out
expect_line 'no scree in build/release/bin or build/cpu-release/bin: build it, or say which with --scree PROGRAM'
run comparison.py run --out out --scree ./missing
expect_line '--scree ./missing: there is no such program'
run variational.py run --out out
expect_line 'no scree_tests_physics and scree_energy_curves in build/release/bin or build/cpu-release/bin'
run variational.py run --out out --bin bench
expect_line '--bin bench: there is no scree_tests_physics'
[ ! -e "$temporary/out" ] || fail "a script that found no program made its folder"

program() { # program BUILD NAME: one that says where it is from, and then fails
  mkdir -p "$temporary/build/$1/bin"
  printf '#!/bin/sh\necho "of %s"\nexit 3\n' "$1" >"$temporary/build/$1/bin/$2"
  chmod +x "$temporary/build/$1/bin/$2"
}
program cpu-release scree
run comparison.py run --out out
grep -q 'of cpu-release' "$temporary/said" || fail "$(cat "$temporary/said")"
program release scree
touch -d '1 hour ago' "$temporary/build/release/bin/scree"
run comparison.py run --out out
grep -q 'of cpu-release' "$temporary/said" || fail "$(cat "$temporary/said")"
touch -d '2 hours ago' "$temporary/build/cpu-release/bin/scree"
run comparison.py run --out out
grep -q 'of release' "$temporary/said" || fail "$(cat "$temporary/said")"
