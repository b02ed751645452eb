#!/usr/bin/env bash
# check_headers.sh CXX SOURCE_DIR GENERATED_DIR [SECONDS]: .h files of the libraries compile on their own with the plain C++
# compiler, with Eigen for those inside of host/. Where the source of the same name includes its header first, building it has shown that. Those that the last
# commit changed come first, then the others in an order that differs from commit to commit: when the time (12 s) is over,
# the rest is left to later runs.
set -euo pipefail
cxx=$1 source_dir=$2 generated_dir=$3
export seconds=${4:-12}
eigen=$(pkg-config --cflags-only-I eigen3 2>/dev/null || echo -I/usr/include/eigen3)
export eigen
cd "$source_dir"
left=$(mktemp)
trap 'rm -f "$left"' EXIT

check_one() {
  if [ "$(($(date +%s) - started))" -ge "$seconds" ]; then
    echo "$3" >>"$4"
    return 0
  fi
  local more=""
  [[ $3 != host/*/* ]] || more=$eigen
  # shellcheck disable=SC2086
  "$1" -std=c++20 -fopenmp -fsyntax-only -I. -I"$2" $more -include "$3" -x c++ /dev/null
}
started=$(date +%s)
export -f check_one
export started
folders=()
for folder in */; do # but generated, shared and test code
  [[ ${folder%/} =~ ^(build.*|out|shared|bench|tests)$ ]] || folders+=("${folder%/}")
done
git=(git -c "safe.directory=$source_dir")
commit=$("${git[@]}" rev-parse HEAD 2>/dev/null || true)
changed=$("${git[@]}" diff --name-only HEAD~1 2>/dev/null || true)
headers=$(find "${folders[@]}" -name '*.h' ! -name '*.inst.h' ! -path 'host/cli/*' ! -path 'host/python/*' |
  while read -r header; do
    own=${header%.h}.cpp
    [ -f "$own" ] && [ "$(grep -m 1 '^#include' "$own")" = "#include \"$header\"" ] && continue
    rank=1
    grep -qxF "$header" <<<"$changed" && rank=0
    echo "$rank $(cksum <<<"$commit $header" | cut -d ' ' -f 1) $header"
  done | sort -n -k 1,1 -k 2,2 | cut -d ' ' -f 3)
xargs -r -n 1 -P "$(nproc)" bash -c 'check_one "$1" "$2" "$4" "$3" || { echo "$4: does not compile on its own"; exit 1; }' \
  check "$cxx" "$generated_dir" "$left" <<<"$headers"
echo "$(wc -l <<<"$headers") headers, $(wc -l <"$left") of them left for later runs"
