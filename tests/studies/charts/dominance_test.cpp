#include "studies/charts/dominance.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "studies/charts/chart_speed_accuracy.h"

// Tests which points of other methods beat ours in a chart. A point is {time, error}. The points are
// synthetic; their relations are read off by hand.

namespace osteon::studies {
namespace {

using Indices = std::vector<std::size_t>;

TEST(Dominance, ClassifiesEachPointAgainstOurs) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  // Ours (true): a front of three points, and one that another of ours beats. Each point's comment starts
  // with its index.
  const std::vector<RivalPoint> points{
      {{10.0, 4.0}, true},   // 0
      {{20.0, 2.0}, true},   // 1
      {{40.0, 1.0}, true},   // 2
      {{40.0, 3.0}, true},   // 3
      {{5.0, 10.0}, false},  // 4: faster than all of ours, less exact than all
      {{15.0, 3.0}, false},  // 5: only our 0 is as fast, and 0 is less exact
      {{15.0, 1.5}, false},  // 6: beats 1 and 3
      {{30.0, 2.5}, false},  // 7: our 1 is faster and more exact; beats 3
      {{50.0, 0.9}, false},  // 8: slower than all of ours, more exact than all
      {{10.0, 4.0}, false},  // 9: equal to 0
      {{nan, 0.1}, false},   // 10: not measured
      {{0.0, 0.1}, false}};  // 11: not measured
  const Dominance found = CompareWithOurs(points);
  EXPECT_TRUE(found.ours_measured);
  EXPECT_EQ(found.beat_all_ours, Indices{});
  EXPECT_EQ(found.faster_than_all_ours, Indices{4});
  EXPECT_EQ(found.ahead, (Indices{5, 6, 8}));
  ASSERT_EQ(found.beaten.size(), 2u);
  EXPECT_EQ(found.beaten[0].ours, 1u);
  EXPECT_EQ(found.beaten[0].by, Indices{6});
  EXPECT_EQ(found.beaten[1].ours, 3u);
  EXPECT_EQ(found.beaten[1].by, (Indices{6, 7})) << "5 has the error of 3, which is not smaller";
}

TEST(Dominance, APointBeatsAllOfOursOnlyIfFasterAndMoreExactThanEach) {
  const std::vector<RivalPoint> points{{{10.0, 4.0}, true},
                                       {{20.0, 2.0}, true},
                                       {{9.0, 1.9}, false},
                                       {{9.0, 2.0}, false},
                                       {{10.0, 1.0}, false}};
  EXPECT_EQ(CompareWithOurs(points).beat_all_ours, Indices{2});
}

TEST(Dominance, WithoutAPointOfOursNothingIsCompared) {
  const std::vector<RivalPoint> points{{{9.0, 1.9}, false}};
  const Dominance found = CompareWithOurs(points);
  EXPECT_FALSE(found.ours_measured);
  EXPECT_TRUE(found.beat_all_ours.empty());
  EXPECT_TRUE(found.ahead.empty());
}

/// A measured point of a method: all five errors are `error`, the depth's in mm.
SpeedAccuracyPoint Point(const std::string& method, double length_mm, double p50_us, double p999_us,
                         double error) {
  SpeedAccuracyPoint point{.method = method, .device = "d", .length_m = 1e-3 * length_mm};
  SeedScores seed;
  seed.frame_us.p50_us = p50_us;
  seed.frame_us.p999_us = p999_us;
  seed.scores.depth_error_m = 1e-3 * error;
  seed.scores.volume_error = seed.scores.force.force_relative = seed.scores.ripple = error;
  seed.scores.force.normal_rms_deg = error;
  point.seeds = {seed};
  return point;
}

TEST(Dominance, TheTableNamesMethodAndLengthForEachErrorAndTime) {
  SpeedAccuracyResult result;
  result.points = {Point("cpu", 3, 20, 200, 0.10), Point("cpu-split", 8, 30, 400, 0.05),
                   Point("voxel", 0.5, 25, 500, 0.04)};
  result.points[2].seeds[0].scores.ripple = 0.20;
  const auto median = DominanceTable(result, ChartTime::kMedian);
  ASSERT_EQ(median.size(), 6u) << "a heading, and five errors";
  const std::vector<std::string> ahead{"none", "voxel 0.5 mm", "voxel 0.5 mm", "none"};
  for (std::size_t i = 1; i <= 4; ++i)  // in depth, volume, force and normal, voxel beats cpu-split
    EXPECT_EQ(std::vector(median[i].begin() + 1, median[i].end()), ahead) << median[i][0];
  EXPECT_EQ(median[1][0], "depth");
  EXPECT_EQ(median[4][0], "normal");
  EXPECT_EQ(median[5], (std::vector<std::string>{"ripple", "none", "none", "none", "none"}));
  // voxel's worst frame is slower than all of ours, so voxel is ahead in error only
  const auto worst = DominanceTable(result, ChartTime::kWorst);
  EXPECT_EQ(worst[1], (std::vector<std::string>{"depth", "none", "none", "voxel 0.5 mm", "none"}));
  EXPECT_EQ(worst[5][3], "none");

  const nlohmann::json json = nlohmann::json::parse(SpeedAccuracyJson(result)).at("dominance");
  const nlohmann::json& depth = json.at("median").at("depth");
  ASSERT_EQ(depth.at("beaten").size(), 1u);
  EXPECT_EQ(depth.at("beaten")[0].at("ours").at("method"), "cpu-split");
  EXPECT_EQ(depth.at("beaten")[0].at("by")[0].at("method"), "voxel");
  EXPECT_EQ(depth.at("beaten")[0].at("by")[0].at("frame_us"), 25.0);
  EXPECT_EQ(depth.at("beat_all_ours"), nlohmann::json::array());
  EXPECT_EQ(json.at("p999").at("depth").at("beaten"), nlohmann::json::array());
  EXPECT_EQ(json.at("p999").at("depth").at("ahead")[0].at("frame_us"), 500.0);

  result.points.erase(result.points.begin(), result.points.begin() + 2);
  EXPECT_EQ(DominanceTable(result, ChartTime::kMedian)[1][1], "ours was not measured");
}

}  // namespace
}  // namespace osteon::studies
