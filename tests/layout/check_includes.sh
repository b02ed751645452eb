#!/usr/bin/env bash
# check_includes.sh ROOT: reads the #include lines of the source tree at ROOT and prints, as
# file:line: reason, each one that goes against the layering. Exit status 1 when there are any.
#
#   kernels/    kernels, shapes             shapes/     shapes, kernels/math and kernels/bodies
#   solvers/    kernels, solvers            collision/  kernels, shapes, collision
#   dynamics/   kernels, shapes, collision, solvers, dynamics, some of host
#   host/       kernels, shapes, solvers, host, dynamics/*.h
#   scenes/     scenes and host/*.h         tests/reference/  anything but kernels/
# Nobody includes tests/, bench/, host/cli/ or host/python/. kernels/, collision/ and solvers/ use only
# the standard library and CUDA beside these, and sources of solvers/assembled/ and rolling/ Eigen; host/*.h has
# nothing of CUDA. The folders of kernels/, solvers/, dynamics/ and host/ have rules of their own, `within` below;
# a folder without a rule is a fault. Which folders of host/ those of dynamics/ may include, and the other way, is in
# `across`. docs/ARCHITECTURE.md draws all of it.
set -euo pipefail
cd "$1"

files=()
for folder in */; do
  folder=${folder%/}
  case $folder in
    build* | bench | tests | out | shared) continue ;;
  esac
  while IFS= read -r file; do files+=("$file"); done < <(
    find "$folder" -type f \( -name '*.h' -o -name '*.cpp' -o -name '*.cu' -o -name '*.cuh' \) \
      ! -path 'host/cli/*' ! -path 'host/python/*' | LC_ALL=C sort)
done
if [ -d tests/reference ]; then
  while IFS= read -r file; do files+=("$file"); done < <(find tests/reference -type f -name '*.[hc]*' | LC_ALL=C sort)
fi
[ ${#files[@]} -gt 0 ] || { echo "no sources below $1"; exit 1; }

awk '
  function fault(reason) { print FILENAME ":" FNR ": " reason; faults++ }
  # folder_in("kernels/math/vec3.h") is "math", and "." for a file beside the folders.
  function folder_in(path,  part) { return split(path, part, "/") > 2 ? part[2] : "." }
  BEGIN {
    allowed["kernels"] = " kernels shapes "
    allowed["shapes"] = " kernels shapes "
    allowed["collision"] = " kernels shapes collision "
    allowed["solvers"] = " kernels solvers "
    allowed["dynamics"] = " kernels shapes collision solvers dynamics host "
    allowed["host"] = " kernels shapes solvers dynamics host "
    allowed["scenes"] = " host scenes "
    allowed["tests"] = " tests collision solvers dynamics host scenes "
    is_layer = " kernels shapes collision solvers dynamics host scenes tests bench "

    # What a folder may include of the tree that it is in; each may include itself.
    within["kernels/."] = " "
    within["kernels/math"] = " . "
    within["kernels/backend"] = " . math "
    within["kernels/bodies"] = " . math backend "
    within["kernels/contact"] = " . math backend bodies "
    within["kernels/broad_phase"] = " . math backend bodies contact "
    within["kernels/narrow_phase"] = " . math backend bodies contact broad_phase "
    within["kernels/step"] = " . math backend bodies contact broad_phase narrow_phase "
    within["kernels/variational"] = " . math backend bodies contact broad_phase narrow_phase step "
    within["kernels/solve"] = " . math backend bodies contact "
    within["kernels/render"] = " . math backend bodies "
    within["kernels/affine"] = " . math backend bodies narrow_phase "
    within["solvers/."] = " assembled "
    within["solvers/assembled"] = " "
    within["solvers/rolling"] = " assembled "
    within["dynamics/."] = " "
    within["dynamics/ranks"] = " . "
    within["dynamics/rigid"] = " . ranks "
    within["dynamics/variational"] = " . rigid "
    within["dynamics/affine"] = " . rigid "
    within["host/."] = " "
    within["host/layouts"] = " . "
    within["host/plot"] = " . "
    within["host/render"] = " . "
    within["host/problems"] = " . "
    within["host/scene_reader"] = " . scene layouts "
    within["host/scene"] = " . scene_reader layouts io "
    within["host/io"] = " . scene problems "
    within["host/ranks"] = " . io "
    within["host/engine"] = " . scene problems "
    within["host/solve"] = " . problems io plot "
    within["host/variational"] = " . "

    # What a folder of dynamics/ may include of host/, and one of host/ of dynamics/.
    across["dynamics/. host"] = " . render "
    across["dynamics/ranks host"] = across["dynamics/rigid host"] = " . scene problems render "
    across["dynamics/variational host"] = across["dynamics/affine host"] = " . scene render "
    across["host/scene dynamics"] = across["host/scene_reader dynamics"] = " . "
    across["host/io dynamics"] = " . "
    across["host/engine dynamics"] = " . ranks "
    cuda = "^(cuda|cub/|thrust/|cusparse|cooperative_groups|nvtx3/|mma\\.h|math_constants\\.h)"
  }
  FNR == 1 {
    from = FILENAME
    sub(/\/.*$/, "", from)
    place = from "/" folder_in(FILENAME)
    has_rules = from ~ /^(kernels|solvers|dynamics|host)$/
    if (!(from in allowed) || (has_rules && !(place in within))) fault("no rule for the includes of this folder")
  }
  /^[ \t]*#[ \t]*include[ \t]*[<"]/ {
    quoted = $0 ~ /include[ \t]*"/
    path = $0
    sub(/^[^<"]*[<"]/, "", path)
    sub(/[>"].*$/, "", path)
    to = path
    sub(/\/.*$/, "", to)
    in_tree = index(path, "/") && index(is_layer, " " to " ")
    goal = to "/" folder_in(path)

    if (path ~ /(^|\/)\.\.\//) {
      fault("\"" path "\": includes are written from the root")
    } else if (in_tree && path ~ /^host\/(cli|python)\//) {
      fault("nobody includes host/cli or host/python (" path ")")
    } else if (in_tree && !index(allowed[from], " " to " ")) {
      fault(from " may not include " to " (" path ")")
    } else if (in_tree && from == to && has_rules && place != goal &&
               !index(within[place], " " folder_in(path) " ")) {
      fault(place " may not include " goal " (" path ")")
    } else if (in_tree && (from to) ~ /^(dynamicshost|hostdynamics)$/ &&
               !index(across[place " " to], " " folder_in(path) " ")) {
      fault(place " may not include " goal " (" path ")")
    } else if (from == "shapes" && to == "kernels" && folder_in(path) !~ /^(\.|math|bodies)$/) {
      fault("shapes may not include " goal " (" path ")")
    } else if (in_tree && from == "scenes" && path ~ /^host\/.*\//) {
      fault("scenes may include public host headers only (" path ")")
    } else if ((!quoted || path ~ "/") && !in_tree && from ~ /^(kernels|collision|solvers)$/ &&
               path !~ /^(experimental\/)?[a-z_0-9]+$/ && path !~ cuda && path !~ /^(omp|immintrin)\.h$/ &&
               !(FILENAME ~ /^solvers\/(assembled|rolling)\/.*\.cpp$/ && path ~ /^Eigen\//)) {
      fault(from " may include only the standard library and CUDA (" path ")")
    } else if (FILENAME ~ /^host\/[^\/]*\.h$/ && FILENAME !~ /\.inst\.h$/ &&
               (path ~ cuda || path ~ /\.cuh$/)) {
      fault("a public host header may not include CUDA (" path ")")
    }
  }
  END { exit faults > 0 }
' "${files[@]}"
