#include "session/view/playback.h"

#include <chrono>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "console/stream/live_json.h"
#include "io/recording/recorder.h"
#include "safety/cell_state.h"
#include "session/view/recording_scan.h"
#include "tests/io/temporary_folder.h"

// Tests of playing a recording: seeking, the history before a time, damaged files and the scan of all events.

namespace osteon::session {
namespace {

constexpr double kSeconds = 40.0;                  // duration of the recording
constexpr rt::Nanoseconds kStart = 5'000'000'000;  // an arbitrary time

// Writes a recording of kSeconds in which the force in newtons equals the time in seconds, with an event each
// 5 s. The force on a page thus tells which time is shown.
void WriteRecording(const std::filesystem::path& path) {
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

// One recording for all tests, since writing it takes longer than a test.
class PlaybackTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new io::test::TemporaryFolder;
    WriteRecording(File());
  }
  static void TearDownTestSuite() { delete folder_; }
  static std::filesystem::path File() { return folder_->path() / "r.mcap"; }
  // Whether the condition becomes true within 20 s.
  static bool Eventually(const std::function<bool()>& condition) {
    for (const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
         std::chrono::steady_clock::now() < end;) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
  static io::test::TemporaryFolder* folder_;
};
io::test::TemporaryFolder* PlaybackTest::folder_ = nullptr;

TEST_F(PlaybackTest, SeekStartsAtMostOneChunkBeforeTheWantedTime) {
  auto timeline = RecordingTimeline::Open(File());
  ASSERT_TRUE(timeline) << timeline.error();
  EXPECT_NEAR(timeline->duration_s(), kSeconds, 1e-6);
  for (const double at_s : {12.345, 0.0, 39.99, 3.0, -5.0, 1e9}) {
    const double wanted_s = std::clamp(at_s, 0.0, kSeconds);
    const double begins_s = timeline->Seek(at_s);
    EXPECT_LE(begins_s, wanted_s);
    EXPECT_GE(begins_s, wanted_s - 0.6) << "a chunk has a quarter of a second";
    const auto topic = timeline->Next();
    ASSERT_TRUE(topic) << topic.error();
  }
}

TEST_F(PlaybackTest, ATruncatedRecordingIsReadUpToItsEnd) {
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

TEST_F(PlaybackTest, AFileThatIsNoRecordingIsRefusedWithItsName) {
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
    // the force equals the time
    EXPECT_TRUE(Eventually([&] { return std::abs(feed.Newest().tick.F_coupling_T_W.f.x - at_s) < 0.01; }))
        << at_s;
    const console::LiveWindow shown = feed.Newest();
    EXPECT_NEAR(static_cast<double>(shown.frame.model.frame), static_cast<double>(shown.tick.tick), 1.0);
    EXPECT_FALSE(playback.state().playing);
  }
}

// The history that a feed gives to a page that opens now: windows of its charts, and events.
struct Past {
  std::vector<console::LiveWindow> windows;
  std::vector<io::RecordedEvent> events;

  explicit Past(const console::LiveFeed& feed) {
    std::uint64_t seen = 0, seen_events = 0;
    windows = feed.Since(seen);
    events = feed.EventsSince(seen_events);
  }
  [[nodiscard]] double first_s() const {
    return windows.empty() ? 1e9 : rt::ToSeconds(windows.front().tick.stamp - kStart);
  }
  [[nodiscard]] double last_s() const {
    return windows.empty() ? -1.0 : rt::ToSeconds(windows.back().tick.stamp - kStart);
  }
  // Whether the history begins at or before from_s and ends at to_s (times of the recording).
  [[nodiscard]] bool Has(double from_s, double to_s) const {
    return first_s() <= from_s + 0.05 && std::abs(last_s() - to_s) < 0.002;
  }
};

TEST_F(PlaybackTest, ASeekFillsTheHalfMinuteBeforeItWithoutPlaying) {
  auto timeline = RecordingTimeline::Open(File());
  ASSERT_TRUE(timeline);
  console::LiveFeed feed(Playback::kFeedWindows);
  Playback playback(std::move(*timeline), feed);
  for (const double at_s : {12.0, 38.0, 7.5, 0.2}) {
    playback.Seek(at_s);
    const double from_s = std::max(0.0, at_s - 30.0);  // a strip chart shows 30 s
    ASSERT_TRUE(Eventually([&] { return Past(feed).Has(from_s, at_s); })) << at_s;
    const Past past(feed);
    double end_N = past.windows.front().force_N.least;
    for (const console::LiveWindow& w : past.windows) {
      EXPECT_NEAR(w.force_N.least, end_N, 1.5e-3) << "no tick is left out: the force is the time";
      end_N = w.force_N.most;
    }
    EXPECT_NEAR(end_N, at_s, 2e-3);
    std::vector<std::string> events, wanted;
    for (const io::RecordedEvent& event : past.events)
      if (event.stamp >= kStart + static_cast<rt::Nanoseconds>(1e9 * from_s)) events.push_back(event.text);
    for (int i = 1; 5 * i <= at_s; ++i)
      if (5 * i >= from_s) wanted.push_back("event " + std::to_string(i));
    EXPECT_EQ(events, wanted) << at_s;
    EXPECT_FALSE(playback.state().playing);
    EXPECT_EQ(playback.state().at_s, at_s);
  }
}

// Two pages at one time of a recording must agree, whatever each showed before.
TEST_F(PlaybackTest, TheHistoryBeforeATimeDoesNotDependOnEarlierSeeks) {
  const auto shown = [](std::initializer_list<double> places) {
    auto timeline = RecordingTimeline::Open(File());
    console::LiveFeed feed(Playback::kFeedWindows);
    Playback playback(std::move(*timeline), feed);
    double at_s = 0.0;
    for (const double place : places) {
      playback.Seek(at_s = place);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    EXPECT_TRUE(Eventually([&] { return Past(feed).Has(std::max(0.0, at_s - 30.0), at_s); })) << at_s;
    return console::LiveJson(Past(feed).windows, {});
  };
  EXPECT_EQ(shown({33.0}), shown({39.0, 1.0, 33.1, 33.0}));
}

// The first chunk after 5 s is damaged. A seek to 12 s must lose only older history; playing from 5 s must
// fail.
TEST_F(PlaybackTest, ADamagedChunkBeforeASeekCostsOnlyHistory) {
  const auto damaged = folder_->path() / "damaged.mcap";
  std::filesystem::copy_file(File(), damaged, std::filesystem::copy_options::overwrite_existing);
  auto stream = io::RecordingStream::Open(damaged);
  ASSERT_TRUE(stream && stream->Next());
  for (const io::McapChunkPlace& chunk : stream->FindChunks()) {
    if (static_cast<rt::Nanoseconds>(chunk.first_ns) < kStart + 5 * rt::kSecond) continue;
    std::fstream file(damaged, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(chunk.offset) + 200);
    file.write("damage", 6);
    break;
  }
  auto timeline = RecordingTimeline::Open(damaged);
  ASSERT_TRUE(timeline) << timeline.error();
  console::LiveFeed feed(Playback::kFeedWindows);
  Playback playback(std::move(*timeline), feed);
  playback.Seek(12.0);
  ASSERT_TRUE(Eventually([&] { return std::abs(Past(feed).last_s() - 12.0) < 0.002; }));
  playback.Play();
  EXPECT_TRUE(Eventually([&] { return playback.state().at_s > 12.2; }));
  EXPECT_EQ(playback.state().error, "");
  playback.Seek(5.0);  // a little before the damage
  playback.Play();
  EXPECT_TRUE(Eventually([&] { return !playback.state().error.empty(); }));
}

// Align keeps two playbacks at the same time: it must neither drop ticks nor restart the feed.
TEST_F(PlaybackTest, AlignShiftsTheTimeWithoutAGapInTheFeed) {
  auto timeline = RecordingTimeline::Open(File());
  ASSERT_TRUE(timeline);
  console::LiveFeed feed(Playback::kFeedWindows);
  Playback playback(std::move(*timeline), feed);
  playback.Seek(2.0);
  ASSERT_TRUE(Eventually([&] { return Past(feed).Has(0.0, 2.0); }));
  const std::uint64_t epoch = feed.epoch();
  playback.Align(9.0);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(playback.state().at_s, 2.0) << "it does not play";
  playback.Play();
  playback.Align(3.0);
  EXPECT_TRUE(Eventually([&] { return playback.state().at_s >= 3.0; }));
  playback.Align(2.9);
  EXPECT_TRUE(Eventually([&] { return playback.state().at_s >= 3.2; }));
  playback.Halt();
  EXPECT_EQ(feed.epoch(), epoch);
  double end_N = 0.0;
  for (const console::LiveWindow& w : Past(feed).windows) {
    EXPECT_NEAR(w.force_N.least, end_N, 1.5e-3);
    end_N = w.force_N.most;
  }
  EXPECT_GT(end_N, 3.0);
}

TEST_F(PlaybackTest, PlaysToTheEndAndThenFromTheBeginning) {
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
  ASSERT_EQ(json["events"].size(), 8u);
  EXPECT_NEAR(json["events"][1][0].get<double>(), 10.0, 1e-3);
  EXPECT_EQ(json["events"][1][1], "event 2");
  EXPECT_NEAR(json["force_N"][7].get<double>(), 8.0, 0.05);
}

}  // namespace
}  // namespace osteon::session
