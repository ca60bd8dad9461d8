#include <memory>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "simulation/engine/reference_engine.h"
#include "studies/failures/failure.h"

// Runs every failure scenario on the reference engine. The claim of each is stated in its header.

namespace osteon::studies {
namespace {

FailureSetting ReferenceSetting() {
  return {.make_engine =
              [](const simulation::Bone& bone, const simulation::Tool& tool, const Pose& X_WG,
                 const simulation::CuttingParams& params) -> std::unique_ptr<simulation::CuttingEngine> {
    return std::make_unique<simulation::ReferenceEngine>(bone, tool, X_WG, params);
  }};
}

class Failures : public testing::TestWithParam<FailureScenario> {};
INSTANTIATE_TEST_SUITE_P(, Failures, testing::ValuesIn(FailureScenarios().begin(), FailureScenarios().end()),
                         [](const auto& scenario) {
                           std::string name = std::to_string(scenario.param.id) + "_" + scenario.param.name;
                           for (char& c : name)
                             if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
                           return name;
                         });

TEST_P(Failures, BaselineFailsAndOursKeepsTheBound) {
  const FailureResult result = GetParam().run(ReferenceSetting());
  std::printf("%d %s: %s, bound %g, %s %g, ours %g %s\n    %s\n", result.id, result.name.c_str(),
              result.metric.c_str(), result.bound, result.baseline_name.c_str(), result.baseline, result.ours,
              result.unit.c_str(), result.note.c_str());
  EXPECT_EQ(result.id, GetParam().id);
  EXPECT_EQ(result.name, GetParam().name);
  EXPECT_TRUE(result.baseline_fails);
  EXPECT_GT(result.baseline, result.bound);
  EXPECT_TRUE(result.ours_passes);
  EXPECT_LE(result.ours, result.bound);
  ASSERT_FALSE(result.plot.series.empty());
  for (const FailureSeries& series : result.plot.series) {
    EXPECT_FALSE(series.name.empty());
    EXPECT_EQ(series.x.size(), series.y.size()) << series.name;
    EXPECT_FALSE(series.x.empty()) << series.name;
  }
}

TEST(FailureList, NumbersAscendAndNamesDiffer) {
  int last = 0;
  std::set<std::string> names;
  for (const FailureScenario& scenario : FailureScenarios()) {
    EXPECT_GT(scenario.id, last);
    EXPECT_LE(scenario.id, 42);
    EXPECT_TRUE(names.insert(scenario.name).second) << scenario.name;
    last = scenario.id;
  }
  EXPECT_GE(names.size(), 7u);
}

TEST(FailureList, AScenarioStopsWhenItsProgressCallbackReturnsFalse) {
  FailureSetting setting = ReferenceSetting();
  setting.progress = [](double) { return false; };
  const FailureResult result = FailureScenarios().front().run(setting);
  EXPECT_FALSE(result.ours_passes);
}

}  // namespace
}  // namespace osteon::studies
