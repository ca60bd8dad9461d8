#include "control/loop/tool_table.h"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tests/control/loop/servo_bench.h"

namespace osteon::control {
namespace {

constexpr double kLonger_m = 0.001;  // distance by which the second tool's apex is farther from the flange

// A table of two tools. The second tool is longer and has guidance; the first has none.
std::vector<LoopTool> TwoTools() {
  LoopTool first{.X_FT = ServoBench::FlangeToTool(), .sensor = ServoBench::Params().sensor};
  LoopTool second = first;
  second.X_FT.translation().z() += kLonger_m;
  second.guidance = GuidanceParams{};
  return {first, second};
}

TEST(ToolTable, SelectsAnotherToolByItsIndex) {
  ToolTable table;
  EXPECT_FALSE(table.IsOther(0));
  EXPECT_EQ(table.index(), 0);
  table.Set(TwoTools(), 0, ServoBench::Params());
  EXPECT_FALSE(table.IsOther(0));
  EXPECT_FALSE(table.IsOther(2));
  EXPECT_FALSE(table.IsOther(-1));
  EXPECT_FALSE(table.guidance());
  ASSERT_TRUE(table.IsOther(1));
  const Pose X_TN = table.Select(1);
  EXPECT_LT((X_TN.translation() - Vector3(0.0, 0.0, kLonger_m)).norm(), 1e-15);
  EXPECT_EQ(table.index(), 1);
  EXPECT_TRUE(table.guidance());
}

TEST(ToolTable, RefusesABadTableAndKeepsThePresentOne) {
  ToolTable table;
  table.Set(TwoTools(), 1, ServoBench::Params());
  EXPECT_THROW(table.Set({}, 0, ServoBench::Params()), std::invalid_argument);
  EXPECT_THROW(table.Set(TwoTools(), 2, ServoBench::Params()), std::invalid_argument);
  std::vector<LoopTool> sheared = TwoTools();
  sheared[0].X_FT.linear()(0, 0) = 2.0;
  EXPECT_THROW(table.Set(sheared, 0, ServoBench::Params()), std::invalid_argument);
  EXPECT_EQ(table.index(), 1);
  EXPECT_EQ(table.tools().size(), 2u);
}

}  // namespace
}  // namespace osteon::control
