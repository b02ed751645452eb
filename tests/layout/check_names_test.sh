#!/usr/bin/env bash
# The checker of names must find those planted here, in its own words, and nothing else.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")" || exit 1
check=$PWD/check_names.sh
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
cd "$tree" || exit 1
mkdir -p kernels shapes solvers collision dynamics host/scene scenes bench tests/host tests/physics
cat >host/scene/a.cpp <<'END'
namespace scree {
namespace {
constexpr double kSize = 1;
constexpr int kCounts[] = {kOne, 2}, kLast = least<kOne, 3>(
                                         4);  // and a second one
std::string text(const Vec3d& v) { return {}; }
int count(int a) {
  const int other = a;
  return other;
}
}  // namespace
int shown(int a) { return a; }
}  // namespace scree
END
cat >host/scene/b.cpp <<'END'
namespace scree {
namespace {
constexpr float kSize = 1;
constexpr double kMass = 2, kLast = 3,
                 kCounts = 4, kOne = 5;
std::string text(const Vec3d& value,
                 int digits) {
  return {};
}
int count(double a) { return 0; }
int count(int b) { return b; }
int other() { return 1; }
}  // namespace
}  // namespace scree
END
cp host/scene/a.cpp tests/host/c.cpp                       # another program
sed 's/scree/scree::part/' host/scene/a.cpp >host/scene/c.cpp # another namespace
found=$(bash "$check" .)
status=$?
diff <(echo "$status: $found") - <<'END' && echo "found the planted names"
1: host/scene/b.cpp:3: kSize is in host/scene/a.cpp:3 too
host/scene/b.cpp:4: kLast is in host/scene/a.cpp:4 too
host/scene/b.cpp:4: kCounts is in host/scene/a.cpp:4 too
host/scene/b.cpp:11: count(int) is in host/scene/a.cpp:7 too
END
