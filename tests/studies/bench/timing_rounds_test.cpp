#include "studies/bench/timing_rounds.h"

#include <gtest/gtest.h>

#include "studies/bench/bench_workloads.h"

// How `bench frame` merges the frames of several rounds into one figure. The times are made up.

namespace osteon::studies {
namespace {

// The timing of frames that took these times.
FrameTiming TimingOf(const std::vector<double>& times_us) {
  FrameTiming timing{.method = "cpu", .device = "d", .times_us = times_us};
  timing.frames = times_us.size();
  timing.frame_us = simulation::FiguresOf(times_us);
  double sum = 0.0;
  for (const double us : times_us) sum += us;
  timing.mean_us = sum / static_cast<double>(timing.frames);
  return timing;
}

// A round for each list of times.
MethodRounds RoundsOf(const std::vector<std::vector<double>>& rounds_us) {
  MethodRounds rounds;
  for (const std::vector<double>& times_us : rounds_us) AddRound(rounds, TimingOf(times_us));
  return rounds;
}

TEST(TimingRounds, FiguresCoverTheFramesOfAllRounds) {
  const MethodRounds rounds = RoundsOf({{1, 2, 9}, {3, 4}, {}});
  EXPECT_EQ(rounds.timing.frames, 5u);
  EXPECT_EQ(rounds.timing.frame_us.p50_us, 3.0);
  EXPECT_EQ(rounds.timing.frame_us.max_us, 9.0);
  EXPECT_DOUBLE_EQ(rounds.timing.mean_us, 19.0 / 5.0);
  ASSERT_EQ(rounds.rounds.size(), 2u) << "a round without a frame counts for nothing";
  EXPECT_EQ(rounds.rounds[0].p50_us, 2.0);
  EXPECT_EQ(rounds.rounds[1].max_us, 4.0);
}

TEST(TimingRounds, ARatioStatesItsRangeOverTheRounds) {
  const MethodRounds slow = RoundsOf({{8, 8, 20}, {12, 12, 12}}), fast = RoundsOf({{2, 2, 10}, {4, 4, 4}});
  const TimeRatio ratio = RatioOf(slow, fast);  // medians of six frames by nearest rank: 12 and 4
  EXPECT_DOUBLE_EQ(ratio.p50, 12.0 / 4.0);
  EXPECT_DOUBLE_EQ(ratio.p999, 20.0 / 10.0);
  EXPECT_DOUBLE_EQ(ratio.p50_range.low, 12.0 / 4.0);
  EXPECT_DOUBLE_EQ(ratio.p50_range.high, 8.0 / 2.0);
  EXPECT_DOUBLE_EQ(ratio.p999_range.low, 20.0 / 10.0);
  EXPECT_DOUBLE_EQ(ratio.p999_range.high, 12.0 / 4.0);
  const TimeRatio same = RatioOf(fast, fast);
  EXPECT_EQ(same.p50, 1.0);
  EXPECT_EQ(same.p999_range.high, 1.0);
}

TEST(BenchWorkloads, AreSelectedByNameOnceAndInTheListsOrder) {
  const auto names = [](const std::vector<std::string>& wanted) {
    std::vector<std::string> found;
    for (const BenchWorkload& workload : SelectWorkloads(wanted)) found.emplace_back(workload.name);
    return found;
  };
  EXPECT_EQ(names({"burr-200", "reamer-30k", "burr-200"}),
            (std::vector<std::string>{"reamer-30k", "burr-200"}));
  std::vector<std::string> all = names({"burr-200", "all"});
  EXPECT_EQ(all.size(), kBenchWorkloads.size());
  all.insert(all.begin(), "all");
  EXPECT_EQ(all, BenchWorkloadNames());
}

}  // namespace
}  // namespace osteon::studies
