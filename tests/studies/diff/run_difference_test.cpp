#include "studies/diff/run_difference.h"

#include <gtest/gtest.h>

#include "io/recording/recorder.h"
#include "safety/acting_limits.h"
#include "safety/cell_state.h"
#include "tests/io/temporary_folder.h"

namespace osteon::studies {
namespace {

// Writes a recording of 2 s that presses with 10 N, and with force_N in one tick. The tool's bend and the
// removed volume are proportional to force_N; the faults are those of the last tick.
std::filesystem::path WriteRecording(const std::filesystem::path& path, double force_N,
                                     std::uint32_t faults = 0, const std::string& gains = "stiffness: 20") {
  io::SessionInfo session{.version = "1", .engine = "cpu", .scene = "block", .tool = "ball"};
  session.config.files = {{.name = "cells/a.yaml", .content = "law: admittance\n" + gains + "\n"}};
  auto recorder = io::Recorder::Open({.path = path, .writer_thread = false}, session);
  EXPECT_TRUE(recorder) << recorder.error();
  for (int i = 1; i <= 2000; ++i) {
    control::TickRecord tick;
    tick.tick = static_cast<std::uint64_t>(i);
    tick.stamp = i * rt::Nanoseconds{1'000'000};
    tick.cell_state = static_cast<std::uint8_t>(safety::CellState::kCutting);
    tick.input.period_s = 0.001;
    tick.F_coupling_T_W.f = {0.0, 0.0, i == 1000 ? force_N : 10.0};
    tick.compute_ns = i % 7;  // computing time: not judged
    tick.faults = i == 2000 ? faults : 0;
    tick.compliance.present = true;
    tick.compliance.bend_m = {0.0, 1e-5 * force_N, 0.0};
    tick.compliance.mount_rad = {0.0, 0.0, 0.001};
    tick.limits = force_N > 100.0 ? 1u : 0u;
    (*recorder)->Push(tick);
    (*recorder)->Drain();
  }
  simulation::FrameRecord frame;
  frame.stamp = 2'000'000'000;
  frame.model.frame = 1;
  frame.model.removed_volume_m3 = 1e-9 * force_N;
  (*recorder)->PushFrame(frame);
  EXPECT_TRUE((*recorder)->Close());
  return path;
}

const FigureDifference& FigureNamed(const RunDifference& runs, const std::string& key) {
  for (const FigureDifference& figure : runs.figures)
    if (figure.first.key == key) return figure;
  throw std::out_of_range(key);
}

class RunDifferenceTest : public ::testing::Test {
 protected:
  RunFigures RecordAndRead(const char* name, double force_N, std::uint32_t faults = 0,
                           const std::string& gains = "k: 20") {
    auto run = ReadRunFigures(WriteRecording(folder_.path() / name, force_N, faults, gains));
    EXPECT_TRUE(run) << run.error();
    return std::move(*run);
  }
  io::test::TemporaryFolder folder_;
};

TEST_F(RunDifferenceTest, EqualRunsAreIdentical) {
  const RunDifference runs = CompareRuns(RecordAndRead("a.mcap", 60.0), RecordAndRead("b.mcap", 60.0), 0.01);
  EXPECT_TRUE(runs.identical);
  EXPECT_EQ(runs.verdict.level, "good");
  EXPECT_TRUE(runs.config.empty());
  EXPECT_NEAR(FigureNamed(runs, "rendered_s").first.value, 2.0, 1e-9);
  EXPECT_NEAR(FigureNamed(runs, "mean_force_N").first.value, (1999 * 10.0 + 60.0) / 2000, 1e-9);
}

TEST_F(RunDifferenceTest, APeakOfOneTickCounts) {
  const RunFigures first = RecordAndRead("a.mcap", 60.0), second = RecordAndRead("b.mcap", 66.0);
  const RunDifference runs = CompareRuns(first, second, 0.01);
  EXPECT_FALSE(runs.identical);
  EXPECT_EQ(runs.verdict.level, "look");
  EXPECT_TRUE(FigureNamed(runs, "peak_force_N").differs());
  EXPECT_NEAR(FigureNamed(runs, "peak_force_N").difference, 6.0, 1e-12);
  EXPECT_TRUE(FigureNamed(runs, "removed_volume_mm3").differs());
  EXPECT_FALSE(FigureNamed(runs, "mean_force_N").differs());
  EXPECT_EQ(CompareRuns(first, second, 0.10).verdict.level, "good") << "within a tenth they are the same";
}

TEST_F(RunDifferenceTest, ComparesHowFarPartsGaveWayAndTheLatency) {
  const RunDifference runs = CompareRuns(RecordAndRead("a.mcap", 60.0), RecordAndRead("b.mcap", 66.0), 0.01);
  EXPECT_NEAR(FigureNamed(runs, "peak_bend_mm").first.value, 0.60, 1e-9);
  EXPECT_NEAR(FigureNamed(runs, "peak_bend_mm").difference, 0.06, 1e-9);
  EXPECT_TRUE(FigureNamed(runs, "peak_bend_mm").differs());
  EXPECT_EQ(FigureNamed(runs, "peak_layer_mm").second.value, 0.0);
  EXPECT_FALSE(FigureNamed(runs, "peak_mount_mm").differs());
  EXPECT_NEAR(FigureNamed(runs, "peak_mount_deg").first.value, 0.0573, 1e-4);
  EXPECT_FALSE(FigureNamed(runs, "latency_hand_to_arm_ms").first.judged);
  EXPECT_FALSE(FigureNamed(runs, "latency_bone_to_hand_ms").differs()) << "the machine's time is in it";
}

TEST_F(RunDifferenceTest, AFaultOfTheSecondRunIsBad) {
  const auto fault = static_cast<std::uint32_t>(safety::Fault::kWorkspace);
  const RunFigures good = RecordAndRead("a.mcap", 60.0), bad = RecordAndRead("b.mcap", 60.0, fault);
  EXPECT_EQ(CompareRuns(good, bad, 0.01).verdict.level, "bad");
  EXPECT_EQ(CompareRuns(good, bad, 0.01).only_second, std::vector<std::string>{"tool outside workspace"});
  EXPECT_EQ(CompareRuns(bad, good, 0.01).verdict.level, "look");
}

TEST_F(RunDifferenceTest, NamesTheFirstLineOfAFileThatDiffers) {
  const RunDifference runs =
      CompareRuns(RecordAndRead("a.mcap", 60.0, 0, "k: 20"), RecordAndRead("b.mcap", 60.0, 0, "k: 25"), 0.01);
  ASSERT_EQ(runs.config.size(), 1u);
  EXPECT_EQ(runs.config[0].file, "cells/a.yaml");
  EXPECT_EQ(runs.config[0].line, 2);
  EXPECT_EQ(runs.config[0].first, "k: 20");
  EXPECT_EQ(runs.config[0].second, "k: 25");
  EXPECT_EQ(runs.verdict.level, "good") << "no figure differs";
}

TEST_F(RunDifferenceTest, RefusesAFileThatIsNoRecording) {
  const auto run = ReadRunFigures("/dev/null");
  ASSERT_FALSE(run);
  EXPECT_NE(run.error().find("/dev/null"), std::string::npos);
}

}  // namespace
}  // namespace osteon::studies
