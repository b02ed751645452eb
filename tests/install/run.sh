#!/usr/bin/env bash
# run.sh CMAKE BUILD_DIR CXX VERSION SOURCE_DIR: installs the build to a temporary prefix, runs the installed program,
# then configures, builds and runs the consumer project against the prefix. Where the system lets us, all of that
# happens with an empty folder in place of the source tree.
set -euo pipefail
cmake=$1 build_dir=$2 cxx=$3 version=$4 source_dir=$5
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
prefix=$temporary/prefix

fail() {
  echo "install test: $*"
  exit 1
}
"$cmake" --install "$build_dir" --prefix "$prefix" >"$temporary/install.log" || fail "$(cat "$temporary/install.log")"
cp -r "$here" "$temporary/project"

# Only public headers, all of them below scree/, which need no others. (That each compiles on its own is tested in the source tree.)
[ "$(ls "$prefix/include")" = scree ] || fail "include/ holds more than scree/: $(ls "$prefix/include")"
for internal in kernels/backend/backend.h kernels/solve collision cli engine; do
  [ ! -e "$prefix/include/scree/$internal" ] || fail "include/scree/$internal is not public"
done
(cd "$prefix/include" && find scree -name '*.h' -printf '#include "%p"\n') >"$temporary/all.cpp"
# shellcheck disable=SC2046
"$cxx" -std=c++20 -fsyntax-only -I"$prefix/include" $(pkg-config --cflags eigen3 2>/dev/null) "$temporary/all.cpp" ||
  fail "the public headers include what is not installed"

for document in README.md docs/user_guide.md docs/theory.md; do
  [ -f "$prefix/share/doc/scree/$document" ] || fail "share/doc/scree/$document is not installed"
done

cat >"$temporary/use.sh" <<'END'
set -euo pipefail
prefix=$1 temporary=$2 cmake=$3 cxx=$4
"$prefix/bin/scree" check drum >/dev/null # its mesh is a file of its own
"$prefix/bin/scree" run incline --steps 2 --quiet --out "$temporary/incline"
"$cmake" -S "$temporary/project" -B "$temporary/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$cxx" \
  -DCMAKE_PREFIX_PATH="$prefix;${CMAKE_PREFIX_PATH:-}" >"$temporary/consumer.log" 2>&1 &&
  "$cmake" --build "$temporary/build" >>"$temporary/consumer.log" 2>&1 || { cat "$temporary/consumer.log"; exit 1; }
"$temporary/build/consumer" "$prefix/share/scree/scenes/incline.json"
END
use=(bash "$temporary/use.sh" "$prefix" "$temporary" "$cmake" "$cxx")
cd "$temporary"
if unshare --mount true 2>/dev/null; then
  printed=$(unshare --mount bash -c 'mkdir "$1/empty" && mount --bind "$1/empty" "$2" && shift 2 && "$@"' hide \
    "$temporary" "$source_dir" "${use[@]}") || fail "without the source tree: $printed"
else
  echo "install test: the source tree is there: this user may not hide it"
  printed=$("${use[@]}") || fail "$printed"
fi
echo "$printed"
[[ $printed == "scree $version: "*" bodies, z = "* ]] || fail "expected 'scree $version: ... bodies, z = ...'"
