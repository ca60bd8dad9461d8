// The pages of stops that are written while the cell still runs.

#include "session/run/live_stops.h"

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "safety/cell_state.h"
#include "tests/io/temporary_folder.h"

namespace osteon::session {
namespace {

using testing::HasSubstr;
using testing::Not;

// Counts the records that LiveStops passes on.
class NextSink final : public io::RecordSink {
 public:
  void TakeTick(const control::TickRecord&) override { ++ticks; }
  void TakeFrame(const simulation::FrameRecord&) override { ++frames; }
  void TakeEvent(const io::RecordedEvent&) override { ++events; }
  int ticks{0}, frames{0}, events{0};
};

std::string TextOf(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

class LiveStopsTest : public testing::Test {
 protected:
  // Half a second of motion, then a fault and a second at rest.
  void StopByFault(LiveStops& stops) {
    for (int i = 0; i < 1500; ++i) {
      control::TickRecord tick;
      tick.tick = static_cast<std::uint64_t>(i);
      tick.stamp = (i + 1) * rt::kMillisecond;
      const bool stopped = i >= 500;
      tick.phase = stopped ? control::Phase::kStopped : control::Phase::kHaptic;
      tick.cell_state =
          static_cast<std::uint8_t>(stopped ? safety::CellState::kStop1 : safety::CellState::kHaptic);
      tick.faults = stopped ? static_cast<std::uint32_t>(safety::Fault::kSensorStale) : 0u;
      stops.TakeTick(tick);
    }
  }
  LiveStopsParams Params(const std::string& console_url) {
    return {.cell = cell_,
            .recording = folder_.path() / "r.mcap",
            .folder = folder_.path(),
            .console_url = console_url,
            .force_limit_N = 200.0};
  }
  const config::CellConfig cell_{config::LoadCell(OSTEON_SOURCE_DIR "/config/cells/demo.yaml")};
  io::test::TemporaryFolder folder_;
  NextSink sink_;
};

TEST_F(LiveStopsTest, AStopsPageIsWrittenWhileTheCellRunsAndLinksToTheConsole) {
  LiveStops stops(Params("http://localhost:8470/"), sink_);
  StopByFault(stops);
  stops.Finish();
  EXPECT_EQ(sink_.ticks, 1500);
  const std::string page = TextOf(folder_.path() / "r_stop_1.html");
  EXPECT_THAT(page, HasSubstr("<a href=\"http://localhost:8470/\">"));
  EXPECT_THAT(page, HasSubstr("osteon view"));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "r_stop_1_ticks.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "r_stop_2.html"));
}

TEST_F(LiveStopsTest, WithoutAConsoleAStopsPageHasNoLink) {
  LiveStops stops(Params(""), sink_);
  StopByFault(stops);
  stops.Finish();
  EXPECT_THAT(TextOf(folder_.path() / "r_stop_1.html"), Not(HasSubstr("The cell still runs")));
}

TEST_F(LiveStopsTest, AMissingFolderDoesNotHinderTheRun) {
  LiveStopsParams params = Params("");
  params.folder /= "gone";
  LiveStops stops(params, sink_);
  StopByFault(stops);
  stops.Finish();
  EXPECT_EQ(sink_.ticks, 1500);
}

}  // namespace
}  // namespace osteon::session
