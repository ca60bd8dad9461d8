#include "studies/tune/tune_guidance.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "config/reading/load.h"

namespace osteon::studies {
namespace {

bool Never() { return false; }

config::CellConfig GuidedCell() { return config::LoadCell(OSTEON_SOURCE_DIR "/config/cells/demo.yaml"); }

control::GuidanceParams ShippedGuidance() {
  control::GuidanceParams guidance;
  guidance.head_m = 0.022;
  return guidance;
}

TEST(TuneGuidance, TheDemoCellAcceptsTheShippedGains) {
  const config::CellConfig cell = GuidedCell();
  const GuidanceMap map = MapGuidance(TuneTaskOf(cell), cell.servo.admittance, ShippedGuidance(), Never);
  EXPECT_TRUE(map.Accepted());
  EXPECT_EQ(map.hands, 95u);
  EXPECT_TRUE(map.unstable.empty());
  EXPECT_GE(map.factor.value, 2.0);
  ASSERT_EQ(map.counts.size(), 5u);
  EXPECT_EQ(map.counts[0][0], 0) << "without guidance";
  EXPECT_EQ(map.counts[2][2], 0) << "the plan's gains";
  session::Verdict verdict;
  JudgeGuidance(map, verdict);
  EXPECT_EQ(verdict.level, session::VerdictLevel::kGood);
  EXPECT_EQ(ToJson(map).at("accepted"), true);
}

TEST(TuneGuidance, ALateSensorIsRefused) {
  const config::CellConfig cell = GuidedCell();
  TuneTask task = TuneTaskOf(cell);
  task.loop.sensor_delay = 5;
  const GuidanceMap map = MapGuidance(task, cell.servo.admittance, ShippedGuidance(), Never);
  EXPECT_FALSE(map.Accepted());
  EXPECT_FALSE(map.unstable.empty());
  session::Verdict verdict;
  JudgeGuidance(map, verdict);
  EXPECT_EQ(verdict.level, session::VerdictLevel::kBad);
}

TEST(TuneGuidance, GainsAboveHalfOfTheStabilityLimitAreRefused) {
  const config::CellConfig cell = GuidedCell();
  control::GuidanceParams guidance = ShippedGuidance();
  guidance.lateral.stiffness = 25e3;  // all hands are stable, but at twice this some are not
  const GuidanceMap map = MapGuidance(TuneTaskOf(cell), cell.servo.admittance, guidance, Never);
  EXPECT_TRUE(map.unstable.empty());
  EXPECT_LT(map.factor.value, 2.0);
  EXPECT_FALSE(map.Accepted());
}

}  // namespace
}  // namespace osteon::studies
