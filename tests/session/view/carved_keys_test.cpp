#include "session/view/carved_keys.h"

#include <chrono>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include "io/recording/recorder.h"
#include "simulation/surface/bone_solid.h"
#include "simulation/surface/welded_surface.h"
#include "simulation/tools/tool_kinds.h"
#include "tests/io/temporary_folder.h"

// Tests of the stored states of a carved bone from which playback continues after a jump in time.

namespace osteon::session {
namespace {

constexpr double kRunSeconds = 40.0, kBoneRadius_m = 0.02;
constexpr rt::Nanoseconds kRecordingStart = 1'000'000'000;  // an arbitrary time

// Writes a recording in which the tool swings ±10 mm at the bone's top and sinks by 0.1 mm/s. The spindle
// stands still in the first second of each seven.
void RecordCut(const std::filesystem::path& path) {
  io::SessionInfo session;
  session.stamp = kRecordingStart;
  session.version = "test";
  auto recorder = io::Recorder::Open({.path = path, .writer_thread = false}, session);
  ASSERT_TRUE(recorder) << recorder.error();
  for (std::uint64_t i = 1; i <= static_cast<std::uint64_t>(1e3 * kRunSeconds); ++i) {
    const double time_s = 1e-3 * static_cast<double>(i);
    control::TickRecord tick;
    tick.tick = i;
    tick.stamp = kRecordingStart + static_cast<rt::Nanoseconds>(i) * rt::kMillisecond;
    tick.spindle_rad_per_s = std::fmod(time_s, 7.0) < 1.0 ? 0.0 : 30.0;
    (*recorder)->Push(tick);
    if (i % 4 == 0) {
      simulation::FrameRecord frame;
      frame.stamp = tick.stamp;
      frame.model.frame = i;
      Pose X_WP = Pose::Identity();
      X_WP.translation() = Vector3(0.01 * std::sin(time_s), 0.0, kBoneRadius_m + 1e-3 - 1e-4 * time_s);
      frame.model.X_WP = X_WP;
      frame.model.p_WS_m = X_WP.translation();
      (*recorder)->PushFrame(frame);
    }
    (*recorder)->Drain();
  }
  ASSERT_TRUE((*recorder)->Close());
}

/// A cell whose bone is one ball, so that no file is needed, with a small reamer.
CellSetup MakeSetup() {
  CellSetup setup;
  setup.config.tool.tool = simulation::MakeReamer(4e-3, 1e-3, 0.03, 0.9, Vector3(0.0, 0.0, 0.0));
  setup.bone.balls = {{.center_m = Vector3(0.0, 0.0, 0.0), .radius_m = kBoneRadius_m}};
  return setup;
}

/// Vertices of the carved bone's surface, in G.
std::vector<surface::Vec3> VerticesOf(const CarvedBone& bone) {
  CarvedBone whole = bone;
  whole.CarveAll();
  return surface::WeldSurface(whole.field).vertices_mm;
}

/// Reads the recording and carves the bone until the bone shows this time.
void CarveUpTo(CarvedBone& bone, RecordingTimeline& timeline, double wanted_s) {
  while (bone.at_s < wanted_s) {
    const auto topic = timeline.Next();
    ASSERT_TRUE(topic && *topic != io::RecordedTopic::kOther);
    bone.Take(*topic, timeline);
  }
}

// A bone carved from the nearest stored state equals, bit for bit, the bone carved from the beginning.
TEST(CarvedKeys, CarvingFromAStoredStateEqualsCarvingFromTheBeginning) {
  const io::test::TemporaryFolder folder;
  const auto file = folder.path() / "cut.mcap";
  RecordCut(file);
  const CellSetup setup = MakeSetup();
  const auto solid = surface::UnionOfBalls(setup.bone, 0.5F);
  const auto cut = std::make_shared<const RecordedCut>(RecordedCut{.tools = {setup.config.tool.tool}});
  CarvedBone from_begin(solid, cut);
  const CarvedKeys keys(file, from_begin);
  for (const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
       !keys.complete() && std::chrono::steady_clock::now() < end;)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ASSERT_TRUE(keys.complete());
  EXPECT_EQ(keys.Before(CarvedKeys::kFirstStep_s - 0.01), nullptr) << "from the beginning, that is";

  auto timeline = RecordingTimeline::Open(file), other = RecordingTimeline::Open(file);
  ASSERT_TRUE(timeline && other);
  ASSERT_TRUE(GoOnFrom(from_begin, *timeline));
  const std::size_t uncut = VerticesOf(from_begin).size();
  for (const double wanted_s : {6.5, 17.123, 39.9}) {
    CarveUpTo(from_begin, *timeline, wanted_s);
    const auto key = keys.Before(wanted_s);
    ASSERT_NE(key, nullptr);
    EXPECT_LE(key->at_s, wanted_s);
    EXPECT_GT(key->at_s, wanted_s - CarvedKeys::kFirstStep_s - 0.01);
    CarvedBone from_key = from_begin;  // shows a later time than the key; JumpTo goes back in time
    from_key.JumpTo(*key);
    ASSERT_TRUE(GoOnFrom(from_key, *other));
    CarveUpTo(from_key, *other, wanted_s);
    const auto expected = VerticesOf(from_begin), found = VerticesOf(from_key);
    ASSERT_EQ(found.size(), expected.size()) << wanted_s;
    EXPECT_NE(found.size(), uncut) << "something was cut";
    for (std::size_t i = 0; i < found.size(); ++i)
      ASSERT_TRUE(found[i].x == expected[i].x && found[i].y == expected[i].y && found[i].z == expected[i].z)
          << i;
  }
}

}  // namespace
}  // namespace osteon::session
