#include "session/view/recording_difference.h"

#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/recording/recorder.h"
#include "tests/io/temporary_folder.h"

// Tests of the difference of two recordings in force, position, rotation, depth and removed volume over time.

namespace osteon::session {
namespace {

constexpr rt::Nanoseconds kFirstStamp = 5'000'000'000;

/// A made-up run whose force is 10 N and whose tool goes down with 1 mm/s.
struct MadeRun {
  double seconds{4.0};
  rt::Nanoseconds period{rt::kMillisecond};
  rt::Nanoseconds start{kFirstStamp};
  double bump_N{0.0};                    ///< added to the force in the one tick at 2 s
  double lower_m{0.0}, turned_rad{0.0};  ///< constant offsets of the tool: down, and about y
  double removed_mm3_per_s{100.0};
};

/// Writes the recording of a made-up run.
void RecordRun(const std::filesystem::path& path, const MadeRun& run) {
  io::SessionInfo session;
  session.stamp = run.start;
  session.version = "test";
  auto recorder = io::Recorder::Open({.path = path, .writer_thread = false}, session);
  ASSERT_TRUE(recorder) << recorder.error();
  const auto ticks = static_cast<std::uint64_t>(run.seconds * rt::kSecond / static_cast<double>(run.period));
  for (std::uint64_t i = 1; i <= ticks; ++i) {
    control::TickRecord tick;
    tick.tick = i;
    tick.stamp = run.start + static_cast<rt::Nanoseconds>(i) * run.period;
    const double time_s = rt::ToSeconds(tick.stamp - run.start);
    Pose X_WT = Pose::Identity();
    X_WT.linear() = ExpRotation(Vector3(0.0, run.turned_rad, 0.0));
    X_WT.translation().z() = -1e-3 * time_s - run.lower_m;
    tick.X_WT_cmd = X_WT;
    tick.F_coupling_T_W.f = {10.0 + (std::abs(time_s - 2.0) < 1e-6 ? run.bump_N : 0.0), 0.0, 0.0};
    simulation::FrameRecord frame;
    frame.model.frame = i;
    frame.stamp = tick.stamp;
    frame.cup_depth_m = -tick.X_WT_cmd.p.z;
    frame.model.removed_volume_m3 = 1e-9 * run.removed_mm3_per_s * time_s;
    (*recorder)->PushFrame(frame);
    (*recorder)->Push(tick);
    (*recorder)->Drain();
  }
  ASSERT_TRUE((*recorder)->Close());
}

class RecordingDifferenceTest : public testing::Test {
 protected:
  /// Records both runs and waits for the result of their comparison.
  nlohmann::json CompareRuns(const MadeRun& first, const MadeRun& second) {
    const std::array files{folder_.path() / "first.mcap", folder_.path() / "second.mcap"};
    RecordRun(files[0], first);
    RecordRun(files[1], second);
    const RecordingDifference difference(files);
    nlohmann::json json;
    for (const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
         std::chrono::steady_clock::now() < end;) {
      json = nlohmann::json::parse(difference.Json());
      if (json["done"].get<bool>()) return json;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ADD_FAILURE() << "it does not end";
    return json;
  }
  io::test::TemporaryFolder folder_;
};

TEST_F(RecordingDifferenceTest, RunsThatDifferOnlyInTheirStartTimeShowNoDifference) {
  const nlohmann::json json = CompareRuns({}, {.start = kFirstStamp + 123'456'789});
  EXPECT_EQ(json["ticks"], 4000);
  for (const char* quantity : {"force_N", "depth_mm", "apart_mm", "turn_deg", "removed_mm3"})
    EXPECT_EQ(json["most"][quantity][0], 0.0) << quantity;
}

TEST_F(RecordingDifferenceTest, OneTickThatDiffersIsFoundAtItsTime) {
  const nlohmann::json json = CompareRuns({}, {.bump_N = 7.0});
  EXPECT_DOUBLE_EQ(json["most"]["force_N"][0], 7.0);
  EXPECT_NEAR(json["most"]["force_N"][1], 2.0, 1e-6);
  const auto bin = static_cast<std::size_t>(2.0 / json["step_s"].get<double>() + 1e-6);
  EXPECT_DOUBLE_EQ(json["force_apart_N"][bin], 7.0);
  EXPECT_DOUBLE_EQ(json["force_apart_N"][bin - 1], 0.0);
  EXPECT_DOUBLE_EQ(json["force_N"][0][bin], 10.0);
  EXPECT_DOUBLE_EQ(json["force_N"][1][bin], 17.0) << "a peak of one tick is kept";
}

TEST_F(RecordingDifferenceTest, PositionRotationDepthAndVolumeAreCompared) {
  constexpr double kTurned_rad = 0.01;
  const nlohmann::json json =
      CompareRuns({}, {.lower_m = 0.25e-3, .turned_rad = kTurned_rad, .removed_mm3_per_s = 150.0});
  EXPECT_NEAR(json["most"]["apart_mm"][0], 0.25, 1e-9);
  EXPECT_NEAR(json["most"]["depth_mm"][0], 0.25, 1e-9);
  EXPECT_NEAR(json["most"]["turn_deg"][0], 180.0 / std::numbers::pi * kTurned_rad, 1e-9);
  EXPECT_NEAR(json["most"]["removed_mm3"][0], 200.0, 0.1) << "the largest at the end: 50 mm³/s for 4 s";
}

// A run of 1 kHz is compared with one of 250 Hz. Each tick is compared with the other run's newest tick,
// which is at most 3 ms older.
TEST_F(RecordingDifferenceTest, RunsOfDifferentPeriodsAreComparedAtEqualTimes) {
  const nlohmann::json json = CompareRuns({}, {.period = 4 * rt::kMillisecond});
  EXPECT_NEAR(json["most"]["apart_mm"][0], 0.003, 1e-6) << "1 mm/s for three ticks of 1 ms";
  EXPECT_EQ(json["most"]["force_N"][0], 0.0);
}

TEST_F(RecordingDifferenceTest, AShorterRunIsComparedUpToItsEnd) {
  const nlohmann::json json = CompareRuns({}, {.seconds = 1.0});
  EXPECT_EQ(json["ticks"], 1000);
  const auto& first = json["force_N"][0];
  const auto& second = json["force_N"][1];
  EXPECT_DOUBLE_EQ(first[first.size() - 2], 10.0);
  EXPECT_TRUE(second[second.size() - 2].is_null());
  EXPECT_TRUE(json["apart_mm"].back().is_null());
}

}  // namespace
}  // namespace osteon::session
