#include "studies/diff/excited_figures.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "session/setup/cell_setup.h"
#include "studies/diff/run_difference.h"
#include "studies/identify/excited_run.h"
#include "tests/temporary_path.h"

// Recordings of `osteon identify`, made in virtual time: nothing is cut in them, so that the figures of an
// ordinary run say nothing of them.

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;

session::CellSetup Demo() {
  auto setup = session::PrepareCell(fs::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml", std::nullopt);
  EXPECT_TRUE(setup) << (setup ? "" : setup.error());
  return std::move(*setup);
}

RunFigures Excited(const session::CellSetup& setup, const char* name, const ExcitationRequest& request) {
  const fs::path file = TemporaryPath(name);
  const auto run = RunExcited(setup, {.request = request, .recording = file});
  EXPECT_TRUE(run) << run.error();
  auto figures = ReadRunFigures(file);
  EXPECT_TRUE(figures) << (figures ? "" : figures.error());
  return std::move(*figures);
}

ExcitationRequest Free(double peak_m_per_s) {
  return {.axis = 'z', .peak_speed_m_per_s = peak_m_per_s, .seed = 1, .draws = 2, .periods = 2};
}

bool Says(const RunDifference& runs, const std::string& what) {
  for (const std::string& reason : runs.verdict.reasons)
    if (reason.find(what) != std::string::npos) return true;
  return false;
}

const FigureDifference& Of(const RunDifference& runs, const std::string& key) {
  for (const FigureDifference& figure : runs.figures)
    if (figure.first.key == key) return figure;
  throw std::out_of_range(key);
}

TEST(ExcitedDifference, AnArmThatLagsMoreAndAnotherSpeedAreSeen) {
  const session::CellSetup setup = Demo();
  session::CellSetup slower = setup;
  slower.config.simulated.servo.bandwidth_hz *= 0.9;
  const RunFigures first = Excited(setup, "first.mcap", Free(0.05)),
                   slow = Excited(slower, "slow.mcap", Free(0.05)),
                   quiet = Excited(setup, "quiet.mcap", Free(0.02));
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
  EXPECT_NEAR(Of(lags, "bandwidth_hz").first.value, 15.0, 0.1);
  EXPECT_NEAR(Of(lags, "bandwidth_hz").second.value, 13.5, 0.1);
  EXPECT_TRUE(Of(lags, "lag_ms").differs());
  EXPECT_FALSE(Of(lags, "dead_time_ms").differs());
  EXPECT_GT(lags.responses[0].differing(), 10u);
  EXPECT_TRUE(Says(lags, "response by encoders: ")) << lags.verdict.reasons.front();
  EXPECT_EQ(CompareRuns(first, slow, 0.5).verdict.level, "good")
      << "within half of their size they are the same";

  const RunDifference speeds = CompareRuns(first, quiet, 0.01);
  EXPECT_EQ(speeds.verdict.level, "look");
  EXPECT_TRUE(Says(speeds,
                   "the excitation differs: free run, z at 50 mm/s, seed 1, 2 draws of 2 periods | "
                   "free run, z at 20 mm/s"))
      << speeds.verdict.reasons.front();
  EXPECT_FALSE(Of(speeds, "bandwidth_hz").differs()) << "the arm is the same";
}

TEST(ExcitedDifference, RunsOfDifferentKindsAreNotCompared) {
  const session::CellSetup setup = Demo();
  ExcitationRequest rest = Free(0.05), joint = Free(0.15);
  rest.rest_s = 6.0;
  joint.joint = 4;
  const RunFigures noise = Excited(setup, "noise.mcap", rest), moved = Excited(setup, "joint.mcap", joint);
  RunFigures ordinary = noise;
  ordinary.excited.reset();
  EXPECT_EQ(NotComparable(noise, noise), "");
  EXPECT_EQ(
      NotComparable(noise, moved),
      "found a noise run of osteon identify and a run of a joint of osteon identify, accepted two of one "
      "kind");
  EXPECT_NE(NotComparable(ordinary, moved).find("found an ordinary run and "), std::string::npos);
  EXPECT_NEAR(Of(CompareRuns(moved, moved, 0.01), "bandwidth_hz").first.value, 15.0, 0.1);
  EXPECT_EQ(Of(CompareRuns(noise, noise, 0.01), "noise_N").difference, 0.0);
}

TEST(ExcitedDifference, ARunThatWasNotEstimatedIsSaid) {
  const session::CellSetup setup = Demo();
  ExcitationRequest little = Free(0.05);
  little.periods = 1;
  const RunFigures run = Excited(setup, "little.mcap", little);
  ASSERT_TRUE(run.excited);
  EXPECT_NE(run.excited->refused, "");
  const RunDifference runs = CompareRuns(run, run, 0.01);
  EXPECT_EQ(runs.verdict.level, "look");
  EXPECT_TRUE(Says(runs, "the first run was not estimated: "));
}

}  // namespace
}  // namespace osteon::studies
