#include "base/parameter_check.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::base {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

// The error message of a check; empty if the check accepts its parameter.
template <class Check>
std::string Refusal(Check&& check) {
  try {
    check();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(ParameterCheck, NamesStructParameterValueAndRange) {
  constexpr ParameterCheck require("energy tank ");
  EXPECT_EQ(Refusal([&] { require("cap_J", 1000.5, 0.0, 1000.0); }),
            "energy tank cap_J: found 1000.5, accepted 0 … 1000");
  EXPECT_EQ(Refusal([&] { require("cap_J", -1.0, false, "> 0"); }),
            "energy tank cap_J: found -1, accepted > 0");
}

TEST(ParameterCheck, AcceptsTheEndsOfTheRangeAndRefusesNaN) {
  constexpr ParameterCheck require("");
  for (const double end : {-1.0, 1.0}) EXPECT_EQ(Refusal([&] { require("x", end, -1.0, 1.0); }), "");
  EXPECT_NE(Refusal([&] { require("x", kNaN, -1.0, 1.0); }), "");
  for (const double value : {kNaN, kInf}) EXPECT_NE(Refusal([&] { require("x", value, true, ">= 0"); }), "");
}

TEST(ParameterCheck, AllocatesNothingIfItAccepts) {
  const rt::CheckedNoAllocScope scope;
  constexpr ParameterCheck require("a set with a name that is longer than a small string: ");
  require("a parameter with a name that is longer than a small string", 0.5, 0.0, 1.0);
  require("a parameter with a name that is longer than a small string", 0.5, true, "> 0");
}

}  // namespace
}  // namespace osteon::base
