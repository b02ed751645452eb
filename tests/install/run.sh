#!/usr/bin/env bash
# run.sh CMAKE BUILD_DIR CXX VERSION: installs the build to a temporary prefix, then configures,
# builds and runs the consumer project against it.
set -euo pipefail
cmake=$1 build_dir=$2 cxx=$3 version=$4
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT

"$cmake" --install "$build_dir" --prefix "$temporary/prefix" >"$temporary/install.log" ||
  { cat "$temporary/install.log"; exit 1; }
"$cmake" -S "$here" -B "$temporary/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$cxx" \
  -DCMAKE_PREFIX_PATH="$temporary/prefix;${CMAKE_PREFIX_PATH:-}"
"$cmake" --build "$temporary/build"
printed=$("$temporary/build/consumer")
echo "$printed"
if [ "$printed" != "scree $version" ]; then
  echo "expected 'scree $version'"
  exit 1
fi
