#include "session/replay/recorded_report.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/recording/recorder.h"
#include "io/recording/recording_reader.h"
#include "session/planning/recorded_packing.h"
#include "session/run/adaptive_resolution.h"
#include "simulation/engine/state_hash.h"
#include "tests/session/run/virtual_run.h"

namespace osteon::session {
namespace {

using testing::HasSubstr;

// A shipped cell whose packing is planned for this error.
CellSetup PlannedCellSetup(const std::string& cell, double error_m) {
  auto setup = PrepareCell(OSTEON_SOURCE_DIR "/config/cells/" + cell + ".yaml", std::nullopt);
  EXPECT_TRUE(setup) << setup.error();
  const auto packed = PackCell(*setup, {.error_m = error_m, .rate_hz = {}}, {}, false);
  EXPECT_TRUE(packed) << packed.error();
  return std::move(*setup);
}

// Makes the report of a recording, which cuts the bone again. @returns its JSON
nlohmann::json ReportOf(const std::filesystem::path& recording) {
  const std::filesystem::path json = recording.parent_path() / "report.json";
  EXPECT_EQ(RunRecordedReport({.recording = recording, .json = json}), 0);
  std::ifstream stream(json);
  return nlohmann::json::parse(stream);
}

class RecordedReport : public testing::Test {
 protected:
  io::test::TemporaryFolder folder_;
  std::filesystem::path recording_{folder_.path() / "r.mcap"};
};

// An error of 0.14 mm leads to a packing that is neither the scene's own nor the one planned for the scene's
// error.
TEST_F(RecordedReport, CutsTheBoneInThePackingOfTheRun) {
  const CellSetup setup = PlannedCellSetup("thin_plate", 0.14e-3);
  auto engine = MakeEngine(setup, {.engine = "cpu"});
  ASSERT_TRUE(engine) << engine.error();
  const CellRunParams params{.seconds = 3.0, .virtual_time = true, .recording = recording_};
  const auto run = RunCell(setup, **engine, params);
  ASSERT_TRUE(run) << run.error().what;
  ASSERT_GT(run->after.removed_volume_m3, 0.0);

  const nlohmann::json report = ReportOf(recording_);
  EXPECT_EQ(report["state_hash"], simulation::HashText(run->after));
  EXPECT_EQ(report["removed_volume_mm3"], run->after.removed_volume_m3 * 1e9);
  EXPECT_EQ(report["spheres"], setup.bone.balls.size());
  EXPECT_EQ(report["planned"]["error_mm"], 0.14e-3 * 1e3);
  EXPECT_EQ(report["planned"]["zone_spacing_mm"], setup.planned->plan.packed.level.fine.spacing_m * 1e3);
  EXPECT_EQ(report["recut"]["same"], true);
  EXPECT_EQ(report["events"].size(), run->events.size());
}

// The test states that each of the first 300 frames in contact takes 4.6 ms. This is more than the 4 ms of
// the frame rate, so the run coarsens its zones.
TEST_F(RecordedReport, CoarsensTheZonesAfterTheSameFrameAsTheRun) {
  CellSetup setup = PlannedCellSetup("demo", 0.1e-3);
  auto planned = std::make_shared<PlannedCell>(*setup.planned);
  planned->request.timed = true;
  planned->request.rate_hz = 250.0;
  planned->plan.active_balls = 1000.0;
  planned->plan.cost = {.base_us = 400.0, .ball_us = 1.6};
  planned->plan.frame_us = 2000.0;
  setup.planned = std::move(planned);
  const EngineChoice choice{.engine = "cpu"};
  auto engine = MakeEngine(setup, choice);
  ASSERT_TRUE(engine) << engine.error();
  AdaptiveResolution adaptive(setup, {.rate_hz = 250.0, .window = 50, .engine = choice, .at_once = true});
  int contacts = 0;
  CellRunParams params{.seconds = 2.0, .virtual_time = true, .recording = recording_};
  params.adaptive_resolution = &adaptive;
  params.frame_us = [&](const simulation::FrameRecord& record) {
    contacts += record.model.contact_count > 0;
    return contacts < 300 ? 4600.0 : 1000.0;
  };
  const auto run = RunCell(setup, **engine, params);
  ASSERT_TRUE(run) << run.error().what;
  ASSERT_FALSE(run->rezoned.empty());

  const nlohmann::json report = ReportOf(recording_);
  EXPECT_EQ(report["state_hash"], simulation::HashText(run->after));
  EXPECT_EQ(report["recut"]["same"], true);
  ASSERT_TRUE(run->min_wall_m);
  EXPECT_EQ(report["min_wall_mm"], *run->min_wall_m * 1e3);
  ASSERT_EQ(report["rezoned"].size(), run->rezoned.size());
  EXPECT_EQ(report["rezoned"][0]["spheres"], run->rezoned[0].bone.balls.size());
  EXPECT_EQ(report["rezoned"][0]["frame_us_before"], 4600.0);
}

// In wall time frames and ticks come to the file from two rings, so a frame may be written before the tick
// whose pose it has. The copy "early.mcap" has them in this order.
TEST_F(RecordedReport, AcceptsFramesThatWereWrittenBeforeTheirTicks) {
  const CellSetup setup = PlannedCellSetup("thin_plate", 0.14e-3);
  auto engine = MakeEngine(setup, {.engine = "cpu"});
  ASSERT_TRUE(engine) << engine.error();
  const auto run = RunCell(setup, **engine, {.seconds = 3.0, .virtual_time = true, .recording = recording_});
  ASSERT_TRUE(run) << run.error().what;
  const auto recording = io::ReadRecording(recording_);
  ASSERT_TRUE(recording) << recording.error();
  const auto early = folder_.path() / "early.mcap";
  auto recorder = io::Recorder::Open({.path = early, .writer_thread = false}, recording->session);
  ASSERT_TRUE(recorder) << recorder.error();
  std::size_t frame = 0;
  for (std::size_t begin = 0; begin < recording->ticks.size(); begin += 20) {
    const std::size_t end = std::min(begin + 20, recording->ticks.size());
    for (; frame < recording->frames.size() &&
           recording->frames[frame].model.pose_stamp <= recording->ticks[end - 1].stamp;
         ++frame)
      (*recorder)->PushFrame(recording->frames[frame]);
    (*recorder)->Drain();  // writes these frames before their ticks
    for (std::size_t i = begin; i < end; ++i) (*recorder)->Push(recording->ticks[i]);
    (*recorder)->Drain();
  }
  ASSERT_TRUE((*recorder)->Close());
  const nlohmann::json report = ReportOf(early);
  EXPECT_EQ(report["state_hash"], simulation::HashText(run->after));
  EXPECT_EQ(report["recut"]["same"], true);
}

TEST(RecordedPacking, NamesTheRecordedNumberThatIsOutOfRange) {
  const CellSetup setup = PlannedCellSetup("thin_plate", 0.14e-3);
  const io::PackingRecord good = MakePackingRecord(setup);
  ASSERT_TRUE(LevelOf(good));
  EXPECT_EQ(DescribeOtherBalls(good, setup.bone), "");

  const auto refused = [&](auto change) {
    io::PackingRecord packing = good;
    change(packing);
    auto again = PrepareCell(OSTEON_SOURCE_DIR "/config/cells/thin_plate.yaml", std::nullopt);
    const auto packed = PackAsRecorded(*again, packing);
    return packed ? std::string() : packed.error();
  };
  EXPECT_THAT(refused([](auto& packing) { packing.kind = 3; }), HasSubstr("kind: found 3, accepted 0 … 2"));
  EXPECT_THAT(refused([](auto& packing) { packing.spacing_m = 1e-9; }), HasSubstr("spacing: found 1e-06 mm"));
  EXPECT_THAT(refused([](auto& packing) { packing.radius_m = std::nan(""); }),
              HasSubstr("radius: found nan"));
  EXPECT_THAT(refused([](auto& packing) { packing.children = 5000; }), HasSubstr("children: found 5000"));
  EXPECT_THAT(refused([](auto& packing) { packing.error_m = 0.0; }), HasSubstr("error: found 0 mm"));
}

TEST(RecordedPacking, WarnsIfTheBallsDifferFromTheRuns) {
  const CellSetup setup = PlannedCellSetup("thin_plate", 0.14e-3);
  io::PackingRecord packing = MakePackingRecord(setup);
  packing.balls_checksum = "0123456789abcdef";
  auto again = PrepareCell(OSTEON_SOURCE_DIR "/config/cells/thin_plate.yaml", std::nullopt);
  ASSERT_TRUE(PackAsRecorded(*again, packing));
  EXPECT_THAT(again->bone_warning, HasSubstr("0123456789abcdef"));
}

}  // namespace
}  // namespace osteon::session
