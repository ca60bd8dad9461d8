#include "session/view/playback.h"

#include <chrono>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/recording/recorder.h"
#include "safety/cell_state.h"
#include "session/view/recording_scan.h"
#include "tests/io/temporary_folder.h"

namespace osteon::session {
namespace {

constexpr double kSeconds = 20.0;
constexpr rt::Nanoseconds kStart = 5'000'000'000;

// A recording of kSeconds whose force is the time, with an event each 5 s.
void Record(const std::filesystem::path& path) {
  io::SessionInfo session;
  session.stamp = kStart;
  session.version = "test";
  auto recorder = io::Recorder::Open({.path = path, .writer_thread = false}, session);
  ASSERT_TRUE(recorder) << recorder.error();
  for (std::uint64_t i = 1; i <= static_cast<std::uint64_t>(1e3 * kSeconds); ++i) {
    control::TickRecord tick;
    tick.tick = i;
    tick.stamp = kStart + static_cast<rt::Nanoseconds>(i) * rt::kMillisecond;
    tick.cell_state = static_cast<std::uint8_t>(safety::CellState::kCutting);
    tick.F_coupling_T_W.f = {1e-3 * static_cast<double>(i), 0.0, 0.0};
    simulation::FrameRecord frame;
    frame.model.frame = i;
    frame.stamp = tick.stamp;
    (*recorder)->PushFrame(frame);
    (*recorder)->Push(tick);
    if (i % 5000 == 0) (*recorder)->PushEvent(tick.stamp, "event " + std::to_string(i / 5000));
    (*recorder)->Drain();
  }
  ASSERT_TRUE((*recorder)->Close());
}

class PlaybackTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new io::test::TemporaryFolder;
    Record(File());
  }
  static void TearDownTestSuite() { delete folder_; }
  static std::filesystem::path File() { return folder_->path() / "r.mcap"; }
  static bool Eventually(const std::function<bool()>& is) {
    for (const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
         std::chrono::steady_clock::now() < end;) {
      if (is()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
  static io::test::TemporaryFolder* folder_;
};
io::test::TemporaryFolder* PlaybackTest::folder_ = nullptr;

TEST_F(PlaybackTest, AnyTimeIsReachedByOneChunk) {
  auto timeline = RecordingTimeline::Open(File());
  ASSERT_TRUE(timeline) << timeline.error();
  EXPECT_NEAR(timeline->duration_s(), kSeconds, 1e-6);
  for (const double at_s : {12.345, 0.0, 19.99, 3.0, -5.0, 1e9}) {
    const double wanted_s = std::clamp(at_s, 0.0, kSeconds);
    const double begins_s = timeline->Seek(at_s);
    EXPECT_LE(begins_s, wanted_s);
    EXPECT_GE(begins_s, wanted_s - 0.6) << "a chunk has a quarter of a second";
    const auto topic = timeline->Next();
    ASSERT_TRUE(topic) << topic.error();
  }
}

TEST_F(PlaybackTest, ATornRecordingIsReadAsFarAsItGoes) {
  const auto torn = folder_->path() / "torn.mcap";
  std::filesystem::copy_file(File(), torn, std::filesystem::copy_options::overwrite_existing);
  std::filesystem::resize_file(torn, std::filesystem::file_size(torn) / 2);
  auto timeline = RecordingTimeline::Open(torn);
  ASSERT_TRUE(timeline) << timeline.error();
  EXPECT_GT(timeline->duration_s(), 1.0);
  EXPECT_LT(timeline->duration_s(), kSeconds);
  (void)timeline->Seek(0.5 * timeline->duration_s());
  EXPECT_TRUE(timeline->Next());
}

TEST_F(PlaybackTest, WhatIsNoRecordingIsRefusedWithItsName) {
  const auto file = folder_->path() / "no.mcap";
  std::ofstream(file) << "no recording";
  const auto timeline = RecordingTimeline::Open(file);
  ASSERT_FALSE(timeline);
  EXPECT_NE(timeline.error().find("no.mcap"), std::string::npos) << timeline.error();
}

TEST_F(PlaybackTest, SeeksForwardAndBackAndShowsThatTime) {
  auto timeline = RecordingTimeline::Open(File());
  ASSERT_TRUE(timeline);
  console::LiveFeed feed;
  Playback playback(std::move(*timeline), feed);
  for (const double at_s : {15.0, 2.0, 19.5, 0.5}) {
    playback.Seek(at_s);
    // the force is the time
    EXPECT_TRUE(Eventually([&] { return std::abs(feed.Newest().tick.F_coupling_T_W.f.x - at_s) < 0.01; }))
        << at_s;
    const console::LiveWindow shown = feed.Newest();
    EXPECT_NEAR(static_cast<double>(shown.frame.model.frame), static_cast<double>(shown.tick.tick), 1.0);
    EXPECT_FALSE(playback.state().playing);
  }
}

TEST_F(PlaybackTest, PlaysToTheEndAndFromTheBeginningAgain) {
  auto timeline = RecordingTimeline::Open(File());
  ASSERT_TRUE(timeline);
  console::LiveFeed feed;
  Playback playback(std::move(*timeline), feed);
  playback.SetSpeed(1e9);
  EXPECT_EQ(playback.state().speed, Playback::kMaxSpeed);
  playback.SetSpeed(std::nan(""));
  EXPECT_EQ(playback.state().speed, Playback::kMaxSpeed);
  playback.Seek(kSeconds - 0.2);
  playback.Play();
  EXPECT_TRUE(Eventually([&] { return playback.state().at_s >= kSeconds - 1e-6; }));
  EXPECT_TRUE(Eventually([&] { return !playback.state().playing; }));
  playback.Play();
  EXPECT_TRUE(Eventually([&] { return playback.state().at_s < 10.0 && playback.state().at_s > 0.1; }));
  EXPECT_TRUE(playback.state().error.empty());
}

TEST_F(PlaybackTest, TheScanFindsEveryEventAndEachSecondsForce) {
  const RecordingScan scan(File());
  nlohmann::json json;
  EXPECT_TRUE(Eventually([&] {
    json = nlohmann::json::parse(scan.Json());
    return json["done"].get<bool>();
  }));
  ASSERT_EQ(json["events"].size(), 4u);
  EXPECT_NEAR(json["events"][1][0].get<double>(), 10.0, 1e-3);
  EXPECT_EQ(json["events"][1][1], "event 2");
  EXPECT_NEAR(json["force_N"][7].get<double>(), 8.0, 0.05);
}

}  // namespace
}  // namespace osteon::session
