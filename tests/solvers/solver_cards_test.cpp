// Parameters that cards of several solvers have: one check is made of a value for all of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "solvers/solver_card.h"

namespace scree {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

SolverParameter relaxation(double standard, double high) {
  return {.key = "relaxation",
          .description = "step [-].",
          .standard = standard,
          .low = 0,
          .high = high};
}

constexpr std::array<const char*, 2> kOrders{"given", "colored"};
constexpr std::array<const char*, 2> kOtherOrders{"given", "random"};

SolverParameter order(std::span<const char* const> choices) {
  return {.key = "order", .description = "of contacts.", .choices = choices};
}

/// The parameters of two solvers, "first" and "second".
std::vector<SharedParameter> shared(const SolverParameter& a, const SolverParameter& b) {
  const std::array first{a}, second{b};
  return shared_parameters(
      {{.name = "first", .description = "", .parameters = first, .memory = nullptr},
       {.name = "second", .description = "", .parameters = second, .memory = nullptr}});
}

std::string fault(const SolverParameter& a, const SolverParameter& b) {
  try {
    shared(a, b);
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return "no error";
}

TEST(SolverCards, AParameterOfTwoSolversIsListedOnceWithBoth) {
  const auto same = shared(relaxation(0.5, 1), relaxation(0.5, 1));
  ASSERT_EQ(same.size(), 1u);
  EXPECT_STREQ(same[0].parameter.key, "relaxation");
  EXPECT_THAT(same[0].solvers, ElementsAre("first", "second"));
  EXPECT_EQ(shared(order(kOrders), order(kOrders)).size(), 1u);
  EXPECT_EQ(shared(order(kOrders), relaxation(0.5, 1)).size(), 2u);
}

TEST(SolverCards, ParametersOfOneKeyThatDifferAreRefusedByName) {
  const auto names =
      AllOf(HasSubstr("\"relaxation\""), HasSubstr("\"first\""), HasSubstr("\"second\""));
  EXPECT_THAT(fault(relaxation(0.5, 2), relaxation(0.5, 1)),
              AllOf(names, HasSubstr("between 0 and 2"), HasSubstr("between 0 and 1")));
  EXPECT_THAT(fault(relaxation(0.5, 1), relaxation(0.8, 1)),
              AllOf(names, HasSubstr("default 0.5"), HasSubstr("default 0.8")));
  EXPECT_THAT(fault(order(kOrders), order(kOtherOrders)),
              AllOf(HasSubstr("\"order\""), HasSubstr("\"random\"")));
}

TEST(SolverCards, ParametersOfThisProgramDoNotDiffer) {
  EXPECT_NO_THROW(shared_parameters(solver_cards()));
  EXPECT_EQ(shared_parameters(solver_cards()).size(), solver_parameters().size());
}

}  // namespace
}  // namespace scree
