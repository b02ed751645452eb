#!/usr/bin/env bash
# check_headers.sh CXX SOURCE_DIR GENERATED_DIR: every .h of the libraries compiles on its own with
# the plain C++ compiler. Where the source of the same name includes its header first, building it has shown that.
set -euo pipefail
cxx=$1 source_dir=$2 generated_dir=$3
cd "$source_dir"

check_one() {
  local own=${3%.h}.cpp
  [ -f "$own" ] && [ "$(grep -m 1 '^#include' "$own")" = "#include \"$3\"" ] && return 0
  "$1" -std=c++20 -fopenmp -fsyntax-only -I. -I"$2" -include "$3" -x c++ /dev/null
}
export -f check_one
folders=()
for folder in */; do # but generated, shared and test code
  [[ ${folder%/} =~ ^(build.*|out|shared|bench|tests)$ ]] || folders+=("${folder%/}")
done
find "${folders[@]}" -name '*.h' ! -name '*.inst.h' ! -path 'host/cli/*' ! -path 'host/python/*' -print0 |
  xargs -0 -r -n 1 -P "$(nproc)" bash -c 'check_one "$@" || { echo "$3: does not compile on its own"; exit 1; }' \
    check "$cxx" "$generated_dir"
