#!/usr/bin/env bash
# check_names.sh ROOT: sources of a program are compiled in batches of any size, so that a name of one file's nameless
# namespace is one of its neighbors too. Prints each name that two sources of a program or library of the tree at ROOT
# define, as file:line: reason. Exit status 1 when there are any.
set -euo pipefail
cd "$1"

files=()
while IFS= read -r file; do files+=("$file"); done < <(
  find kernels shapes solvers collision dynamics host scenes bench tests -type f \( -name '*.cpp' -o -name '*.test.h' -o -name '*.inst.h' \) | LC_ALL=C sort)

awk '
  # What is compiled into one program or library: a folder of the tree, and of tests/. Headers are compiled once per backend.
  function program(path,  part) {
    split(path, part, "/")
    if (path ~ /\.h$/) return part[1] " of a backend"
    return part[1] == "tests" || path ~ /^host\/(cli|python)\// ? part[1] "/" part[2] : part[1]
  }
  # "std::string text(const Vec3d& v, int n = 0)" becomes "text(const Vec3d&,int)": names of parameters do not matter.
  function signature(line,  name, list, count, part, i, types) {
    name = line
    sub(/\(.*$/, "", name)
    sub(/^.*[ *&]/, "", name)
    list = line
    sub(/^[^(]*\(/, "", list)
    sub(/\)[^)]*$/, "", list)
    count = split(list, part, ",")
    for (i = 1; i <= count; ++i) {
      sub(/=.*$/, "", part[i])
      gsub(/^ +| +$/, "", part[i])
      if (part[i] ~ /[ &*>][a-z_0-9]+$/) sub(/[a-z_0-9]+$/, "", part[i])
      gsub(/ +/, " ", part[i])
      sub(/ $/, "", part[i])
      types = types (i > 1 ? "," : "") part[i]
    }
    return name "(" types ")"
  }
  function found(what,  key) {
    key = program(FILENAME) " " open_names what
    if (key in first && file_of[key] != FILENAME) {
      print FILENAME ":" start ": " what " is in " first[key] " too"
      faults++
    } else if (!(key in first)) {
      first[key] = FILENAME ":" start
      file_of[key] = FILENAME
    }
  }
  # "constexpr double kMass = 1.5, kSizes[] = {1, 2};" names kMass and kSizes: commas within brackets part nothing.
  function found_constants(  count, part, i) {
    while (sub(/[({<[][^][(){}<>]*[])}>]/, "", constants)) {}
    count = split(constants, part, ",")
    for (i = 1; i <= count; ++i) {
      sub(/ *[=;].*$/, "", part[i])
      sub(/^.*[ *&]/, "", part[i])
      found(part[i])
    }
    constants = ""
  }
  FNR == 1 { inside = 0; constants = ""; pending = ""; open_names = "" }
  /^namespace \{/ { inside = 1; next }
  /^namespace .*\{/ { if (!inside) open_names = open_names $2 "::"; next }
  /^\}  \/\/ namespace$/ { inside = 0; next }
  /^\}  \/\/ namespace / { if (!inside) sub(/[^:]*::$/, "", open_names); next }
  !inside { next }
  pending == "" && /^(struct|class|enum class) [A-Za-z_0-9]+ .*\{/ { start = FNR; found($1 == "enum" ? $3 : $2); next }
  pending == "" && (constants != "" || /^(inline |static )?(constexpr|const) [^(]*=/) {
    if (constants == "") start = FNR
    sub(/ *\/\/.*$/, "")
    constants = constants " " $0
    if (/;$/) found_constants()
    next
  }
  pending == "" && /^[A-Za-z_:\[][^=]*\(/ && !/^(TEST|TYPED_TEST|INSTANTIATE|REGISTER|static_assert|template|using)/ {
    pending = $0
    start = FNR
  }
  pending != "" {
    if (FNR > start) pending = pending " " $0
    if (pending ~ /\{/ || pending ~ /;/) {
      sub(/ *(const)? *(noexcept)? *[{;].*$/, "", pending)
      found(signature(pending))
      pending = ""
    }
  }
  END { exit faults > 0 }
' "${files[@]}"
