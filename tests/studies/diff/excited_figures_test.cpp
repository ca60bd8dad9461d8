#include "studies/diff/excited_figures.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "session/setup/cell_setup.h"
#include "studies/diff/run_difference.h"
#include "studies/identify/excited_run.h"
#include "tests/temporary_path.h"

// Compares recordings of `osteon identify`, made in virtual time. Nothing is cut in these recordings, so
// other figures are compared than in a run: the arm's response and the sensor's noise.

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;

session::CellSetup PrepareDemoCell() {
  auto setup = session::PrepareCell(fs::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml", std::nullopt);
  EXPECT_TRUE(setup) << (setup ? "" : setup.error());
  return std::move(*setup);
}

// Records an excitation of the cell and returns its figures.
RunFigures RecordExcited(const session::CellSetup& setup, const char* name,
                         const ExcitationRequest& request) {
  const fs::path file = TemporaryPath(name);
  const auto run = RunExcited(setup, {.request = request, .recording = file});
  EXPECT_TRUE(run) << run.error();
  auto figures = ReadRunFigures(file);
  EXPECT_TRUE(figures) << (figures ? "" : figures.error());
  return std::move(*figures);
}

// An excitation of the free arm along z.
ExcitationRequest FreeRequest(double peak_m_per_s) {
  return {.axis = 'z', .peak_speed_m_per_s = peak_m_per_s, .seed = 1, .draws = 2, .periods = 2};
}

bool HasReason(const RunDifference& runs, const std::string& what) {
  for (const std::string& reason : runs.verdict.reasons)
    if (reason.find(what) != std::string::npos) return true;
  return false;
}

const FigureDifference& FigureNamed(const RunDifference& runs, const std::string& key) {
  for (const FigureDifference& figure : runs.figures)
    if (figure.first.key == key) return figure;
  throw std::out_of_range(key);
}

TEST(ExcitedDifference, DetectsASlowerArmAndAnotherExcitation) {
  const session::CellSetup setup = PrepareDemoCell();
  session::CellSetup slower = setup;
  slower.config.simulated.servo.bandwidth_hz *= 0.9;
  const RunFigures first = RecordExcited(setup, "first.mcap", FreeRequest(0.05)),
                   slow = RecordExcited(slower, "slow.mcap", FreeRequest(0.05)),
                   quiet = RecordExcited(setup, "quiet.mcap", FreeRequest(0.02));
  ASSERT_TRUE(first.excited);
  EXPECT_EQ(first.excited->refused, "");

  const RunDifference same = CompareRuns(first, first, 0.01);
  EXPECT_TRUE(same.identical);
  EXPECT_EQ(same.verdict.level, "good");
  ASSERT_EQ(same.responses.size(), 2u) << "by encoders and by force";
  EXPECT_EQ(same.responses[0].lines.size(), 27u);
  EXPECT_EQ(same.responses[0].differing(), 0u);

  const RunDifference lags = CompareRuns(first, slow, 0.01);
  EXPECT_EQ(lags.verdict.level, "look");
  EXPECT_NEAR(FigureNamed(lags, "bandwidth_hz").first.value, 15.0, 0.1);
  EXPECT_NEAR(FigureNamed(lags, "bandwidth_hz").second.value, 13.5, 0.1);
  EXPECT_TRUE(FigureNamed(lags, "lag_ms").differs());
  EXPECT_FALSE(FigureNamed(lags, "dead_time_ms").differs());
  EXPECT_GT(lags.responses[0].differing(), 10u);
  EXPECT_TRUE(HasReason(lags, "response by encoders: ")) << lags.verdict.reasons.front();
  EXPECT_EQ(CompareRuns(first, slow, 0.5).verdict.level, "good")
      << "within half of their size they are the same";

  const RunDifference speeds = CompareRuns(first, quiet, 0.01);
  EXPECT_EQ(speeds.verdict.level, "look");
  EXPECT_TRUE(HasReason(speeds,
                        "the excitation differs: free run, z at 50 mm/s, seed 1, 2 draws of 2 periods | "
                        "free run, z at 20 mm/s"))
      << speeds.verdict.reasons.front();
  EXPECT_FALSE(FigureNamed(speeds, "bandwidth_hz").differs()) << "the arm is the same";
}

// A line of the response is compared with the other run's line of the same frequency, at any index. A line
// that only one run has is reported, not compared with its neighbour.
TEST(ExcitedDifference, ComparesLinesOfTheSameFrequency) {
  const auto with_lines = [](std::vector<double> frequencies_hz) {
    ExcitedFigures excited;
    RecordedResponse& response = excited.responses.emplace_back();
    response.by = "encoders";
    for (const double hz : frequencies_hz)
      response.lines.push_back({.hz = hz, .value = {1.0 / hz, 0.0}, .sd = 1e-6});
    return excited;
  };
  std::vector<std::string> only;
  const auto shifted = CompareResponses(with_lines({1.0, 2.0, 4.0}), with_lines({2.0, 4.0}), 0.01, only);
  ASSERT_EQ(shifted.size(), 1u);
  ASSERT_EQ(shifted[0].lines.size(), 2u);
  EXPECT_EQ(shifted[0].lines[0].second.hz, 2.0);
  EXPECT_EQ(shifted[0].differing(), 0u);
  ASSERT_EQ(only.size(), 1u);
  EXPECT_EQ(
      only[0],
      "response by encoders: 1 lines of the first run and 0 of the second are at frequencies that the other "
      "has not");
  only.clear();
  EXPECT_TRUE(CompareResponses(with_lines({1.0}), with_lines({3.0}), 0.01, only).empty());
  EXPECT_EQ(only.size(), 1u);
}

TEST(ExcitedDifference, RefusesToCompareRunsOfDifferentKinds) {
  const session::CellSetup setup = PrepareDemoCell();
  ExcitationRequest rest = FreeRequest(0.05), joint = FreeRequest(0.15);
  rest.rest_s = 6.0;
  joint.joint = 4;
  const RunFigures noise = RecordExcited(setup, "noise.mcap", rest),
                   moved = RecordExcited(setup, "joint.mcap", joint);
  RunFigures ordinary = noise;
  ordinary.excited.reset();
  EXPECT_EQ(NotComparable(noise, noise), "");
  EXPECT_EQ(
      NotComparable(noise, moved),
      "found a noise run of osteon identify and a run of a joint of osteon identify, accepted two of one "
      "kind");
  EXPECT_NE(NotComparable(ordinary, moved).find("found an ordinary run and "), std::string::npos);
  EXPECT_NEAR(FigureNamed(CompareRuns(moved, moved, 0.01), "bandwidth_hz").first.value, 15.0, 0.1);
  EXPECT_EQ(FigureNamed(CompareRuns(noise, noise, 0.01), "noise_N").difference, 0.0);
}

TEST(ExcitedDifference, ReportsARunThatCouldNotBeEstimated) {
  const session::CellSetup setup = PrepareDemoCell();
  ExcitationRequest little = FreeRequest(0.05);
  little.periods = 1;
  const RunFigures run = RecordExcited(setup, "little.mcap", little);
  ASSERT_TRUE(run.excited);
  EXPECT_NE(run.excited->refused, "");
  const RunDifference runs = CompareRuns(run, run, 0.01);
  EXPECT_EQ(runs.verdict.level, "look");
  EXPECT_TRUE(HasReason(runs, "the first run was not estimated: "));
}

}  // namespace
}  // namespace osteon::studies
