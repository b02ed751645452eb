#!/usr/bin/env bash
# check_includes.sh ROOT: reads the #include lines of the source tree at ROOT and prints, as
# file:line: reason, each one that goes against the layering. Exit status 1 when there are any.
#
#   kernels/    kernels                     collision/  kernels, collision
#   solvers/    kernels, solvers            host/       kernels, collision, solvers, host
#   scenes/     scenes and host/*.h         tests/reference/  anything but kernels/
# Nobody includes tests/, bench/, host/cli/ or host/python/. kernels/, collision/ and solvers/ use only
# the standard library and CUDA beside these, and sources of solvers/assembled/ Eigen; host/*.h has
# nothing of CUDA.
set -euo pipefail
cd "$1"

files=()
for folder in kernels collision solvers host scenes tests/reference; do
  [ -d "$folder" ] || continue
  while IFS= read -r file; do files+=("$file"); done < <(
    find "$folder" -type f \( -name '*.h' -o -name '*.cpp' -o -name '*.cu' -o -name '*.cuh' \) \
      ! -path 'host/cli/*' ! -path 'host/python/*' | LC_ALL=C sort)
done
[ ${#files[@]} -gt 0 ] || { echo "no sources below $1"; exit 1; }

awk '
  function fault(reason) { print FILENAME ":" FNR ": " reason; faults++ }
  BEGIN {
    allowed["kernels"] = " kernels "
    allowed["collision"] = " kernels collision "
    allowed["solvers"] = " kernels solvers "
    allowed["host"] = " kernels collision solvers host "
    allowed["scenes"] = " host scenes "
    allowed["tests"] = " tests collision solvers host scenes "
    is_layer = " kernels collision solvers host scenes tests bench "
    cuda = "^(cuda|cub/|thrust/|cusparse|cooperative_groups|nvtx3/|mma\\.h|math_constants\\.h)"
  }
  /^[ \t]*#[ \t]*include[ \t]*[<"]/ {
    quoted = $0 ~ /include[ \t]*"/
    path = $0
    sub(/^[^<"]*[<"]/, "", path)
    sub(/[>"].*$/, "", path)
    split(FILENAME, parts, "/")
    from = parts[1]
    to = path
    sub(/\/.*$/, "", to)
    in_tree = index(path, "/") && index(is_layer, " " to " ")

    if (path ~ /(^|\/)\.\.\//) {
      fault("\"" path "\": includes are written from the root")
    } else if (in_tree && path ~ /^host\/(cli|python)\//) {
      fault("nobody includes host/cli or host/python (" path ")")
    } else if (in_tree && !index(allowed[from], " " to " ")) {
      fault(from " may not include " to " (" path ")")
    } else if (in_tree && from == "scenes" && path ~ /^host\/.*\//) {
      fault("scenes may include public host headers only (" path ")")
    } else if ((!quoted || path ~ "/") && !in_tree && from ~ /^(kernels|collision|solvers)$/ &&
               path !~ /^(experimental\/)?[a-z_0-9]+$/ && path !~ cuda && path !~ /^(omp|immintrin)\.h$/ &&
               !(FILENAME ~ /^solvers\/assembled\/.*\.cpp$/ && path ~ /^Eigen\//)) {
      fault(from " may include only the standard library and CUDA (" path ")")
    } else if (FILENAME ~ /^host\/[^\/]*\.h$/ && FILENAME !~ /\.inst\.h$/ &&
               (path ~ cuda || path ~ /\.cuh$/)) {
      fault("a public host header may not include CUDA (" path ")")
    }
  }
  END { exit faults > 0 }
' "${files[@]}"
