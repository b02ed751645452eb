// The scene `linkage` as it comes: what its joints tell that they bear, and break of.

#include <cmath>
#include <sstream>

#include "tests/cli/program.h"

namespace scree::test {
namespace {

// One joint holds sideways what others hold already, and nothing pushes that way. So it bears a few newtons in its plane.
TEST(CliLinkage, AJointHoldsThatIsStrongerThanItsLoad) {
  const Scratch scratch;
  for (const char* precision : {"float", "double"}) {
    const Result run =
        scree(scratch, {"run", "linkage", "--backend", "cpu", "--precision", precision, "--steps",
                        "300", "--set", "particles.0.count=60", "--set",
                        "output.force_interval=0.001", "--set", "joints.1.break_force=1000",
                        "--quiet", "--force", "--out", (scratch / "a").string()});
    ASSERT_EQ(run.code, 0) << run.err;
    std::ifstream in(scratch / "a/forces.csv");
    double sideways = 0, upward = 0;
    int steps = 0;
    for (std::string line; std::getline(in, line);) {
      std::vector<std::string> fields;
      std::istringstream all(line);
      for (std::string field; std::getline(all, field, ',');) fields.push_back(field);
      if (fields.size() < 8 || fields[3] != "joint" || fields[4] != "1") continue;
      ++steps;
      sideways = std::max(sideways, std::abs(std::stod(fields[6])));
      upward = std::stod(fields[7]);
    }
    EXPECT_EQ(steps, 300);
    EXPECT_LT(sideways, 5) << precision;
    EXPECT_GT(upward, 1) << precision;  // it is not broken
  }
}

}  // namespace
}  // namespace scree::test
