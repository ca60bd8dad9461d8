#include "session/replay/recarve.h"

#include <gtest/gtest.h>

#include "session/replay/recorded_report.h"
#include "tests/session/run/virtual_run.h"

namespace osteon::session {
namespace {

// Runs a cell, then carves its bone again from the recording. The simulation computes its frames at the
// commanded pose under an admittance law, and at the measured pose under an impedance law. The test runs one
// cell of each kind.
class RecarveTest : public testing::TestWithParam<const char*> {};

TEST_P(RecarveTest, TheRecordingAloneGivesTheRunsBoneBitForBit) {
  auto setup =
      SetUpCell(OSTEON_SOURCE_DIR "/config/cells/" + std::string(GetParam()) + ".yaml", std::nullopt);
  ASSERT_TRUE(setup) << setup.error();
  const EngineChoice choice{.engine = "cpu"};
  auto engine = MakeEngine(*setup, choice);
  ASSERT_TRUE(engine) << engine.error();
  const io::test::TemporaryFolder folder;
  const auto file = folder.path() / "r.mcap";
  const auto result = RunCell(*setup, **engine, {.seconds = 3.0, .virtual_time = true, .recording = file});
  ASSERT_TRUE(result) << result.error().what;
  ASSERT_GT(result->after.removed_volume_m3, 0.0);

  const auto recording = io::ReadRecording(file);
  ASSERT_TRUE(recording) << recording.error();
  auto again = SetUpRecorded(recording->session);
  ASSERT_TRUE(again) << again.error();
  ASSERT_TRUE(again->solid) << again->bone_warning;
  EXPECT_TRUE(again->X_WG.isApprox(setup->X_WG, 0.0));
  PackAsScene(*again);
  auto fresh = MakeEngine(*again, choice);
  ASSERT_TRUE(fresh);
  Recarve recarve(**fresh, again->config.servo.law);
  std::size_t frame = 0;
  for (const control::TickRecord& tick : recording->ticks) {
    while (frame < recording->frames.size() && recording->frames[frame].stamp < tick.stamp)
      recarve.Add(recording->frames[frame++]);
    recarve.Add(tick);
  }
  while (frame < recording->frames.size()) recarve.Add(recording->frames[frame++]);
  EXPECT_EQ(recarve.left_out(), 0u);
  // In virtual time a run ends with a frame that was computed but not recorded, so the run's result has one
  // frame more than the recording.
  EXPECT_NEAR((*fresh)->Snapshot().removed_volume_m3, result->after.removed_volume_m3,
              1e-4 * result->after.removed_volume_m3);
  EXPECT_EQ(recording->frames.back().model.removed_volume_m3, (*fresh)->Snapshot().removed_volume_m3);
}

INSTANTIATE_TEST_SUITE_P(Laws, RecarveTest, testing::Values("thin_plate", "thin_plate_impedance"),
                         [](const auto& param) { return std::string(param.param); });

TEST(Recarve, AFrameWithoutItsTickIsLeftOutAndCounted) {
  auto setup = SetUpCell(OSTEON_SOURCE_DIR "/config/cells/thin_plate.yaml", std::nullopt);
  ASSERT_TRUE(setup);
  auto engine = MakeEngine(*setup, {.engine = "cpu"});
  ASSERT_TRUE(engine);
  Recarve recarve(**engine, control::Law::kAdmittance);
  simulation::FrameRecord frame;
  frame.model.pose_stamp = 5;
  recarve.Add(frame);
  EXPECT_EQ(recarve.frames(), 0u);
  EXPECT_EQ(recarve.left_out(), 1u);
}

}  // namespace
}  // namespace osteon::session
