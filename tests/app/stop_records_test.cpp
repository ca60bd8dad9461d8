#include "session/stops/stop_records.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "app/cli/help/faults_command.h"
#include "app/cli/help/states_command.h"
#include "config/reading/load.h"
#include "control/ports.h"
#include "safety/cell_state.h"
#include "tests/app/command.h"
#include "tests/report/report_markup.h"

// Tests the records of stops (a page and a table each) on made-up ticks, and the documented tables of faults
// and states.

namespace osteon::app {
namespace {

using control::Phase;
using control::TickRecord;
using safety::Fault;

config::CellConfig Cell() {
  return config::LoadCell(std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/thin_plate.yaml");
}

constexpr std::uint32_t Bit(Fault fault) { return static_cast<std::uint32_t>(fault); }

// Appends ticks that are 1 ms apart. @param asked  whether a stop is requested in these ticks
void AddTicks(std::vector<TickRecord>& ticks, int count, Phase phase, std::uint32_t faults = 0,
              bool asked = false) {
  for (int i = 0; i < count; ++i) {
    TickRecord tick;
    tick.tick = ticks.size();
    tick.stamp = static_cast<rt::Nanoseconds>(ticks.size() + 1) * rt::kMillisecond;
    tick.phase = phase;
    tick.faults = faults;
    tick.input.stop = asked;
    ticks.push_back(tick);
  }
}

// All stops in the ticks of a whole run.
std::vector<session::StopRecord> FindStops(const std::vector<TickRecord>& ticks) {
  session::StopFinder finder;
  std::vector<session::StopRecord> stops;
  const auto take = [&stops](std::optional<session::StopRecord> stop) {
    if (stop) stops.push_back(std::move(*stop));
  };
  for (const TickRecord& tick : ticks) take(finder.Add(tick));
  take(finder.Finish());
  return stops;
}

// Writes page and table of each stop into the folder.
tl::expected<std::vector<session::WrittenStop>, std::string> WriteStops(
    const std::vector<TickRecord>& ticks, const std::filesystem::path& folder,
    const std::vector<io::RecordedEvent>& events = {}) {
  const config::CellConfig cell = Cell();
  session::StopPages pages({.folder = folder, .stem = "demo", .cell = cell, .recording = "demo.mcap"});
  io::SessionInfo session;
  session.force_limit_N = 150.0;
  for (const TickRecord& tick : ticks) pages.Add(session, tick);
  for (const io::RecordedEvent& event : events) pages.Add(event);
  return pages.Finish();
}

// Ticks of two stops: a fault after 8 s of contact with a recovery, and the end of the run after 1 s of
// contact.
std::vector<TickRecord> TwoStops() {
  std::vector<TickRecord> ticks;
  AddTicks(ticks, 500, Phase::kWaiting);
  AddTicks(ticks, 8000, Phase::kHaptic);
  AddTicks(ticks, 100, Phase::kStopping, Bit(Fault::kInterlock));
  AddTicks(ticks, 100, Phase::kStopped, Bit(Fault::kInterlock) | Bit(Fault::kSession));
  AddTicks(ticks, 900, Phase::kStopped, Bit(Fault::kInterlock) | Bit(Fault::kSession));
  AddTicks(ticks, 300, Phase::kWaiting);
  AddTicks(ticks, 1000, Phase::kHaptic);
  AddTicks(ticks, 50, Phase::kStopping, 0, true);
  AddTicks(ticks, 10, Phase::kStopped, 0, true);
  return ticks;
}

TEST(StopRecords, HoldFiveSecondsBeforeAndHalfASecondAtRest) {
  const std::vector<TickRecord> ticks = TwoStops();
  const std::vector<session::StopRecord> stops = FindStops(ticks);
  ASSERT_EQ(stops.size(), 2u);
  // ticks are numbered from 0, so tick 8500 is the first one of the stop
  EXPECT_EQ(stops[0].ticks[stops[0].stop].tick, 8500u);
  EXPECT_EQ(stops[0].ticks.front().tick, 3500u);
  EXPECT_EQ(stops[0].ticks.back().tick, 8600u + 500u) << "at rest from tick 8600 on";
  EXPECT_EQ(stops[0].ticks.size(), 9101u - 3500u);
  EXPECT_EQ(stops[0].DescribeCause(), "arm left COMMANDING_ACTIVE; motion not permitted");
  EXPECT_FALSE(stops[0].asked);
  EXPECT_EQ(stops[1].ticks[stops[1].stop].tick, 10900u);
  EXPECT_EQ(stops[1].ticks.front().tick, 5900u) << "what came before, the last stop included";
  EXPECT_EQ(stops[1].ticks.back().tick, ticks.back().tick);
  EXPECT_EQ(stops[1].DescribeCause(), "asked for");
  EXPECT_EQ(stops[0].ticks[stops[0].rest].tick, 8600u);
  EXPECT_FALSE(stops[0].cut_off);
  EXPECT_TRUE(stops[1].cut_off);
  EXPECT_STREQ(stops[0].Heading(), "What led to the stop");
  EXPECT_STREQ(stops[1].Heading(), "How the run ended");
}

// During a pause the phase is kWaiting. The record counts this as rest until the motion resumes.
TEST(StopRecords, ShowAPauseForHalfASecondAtRest) {
  for (const int paused : {2000, 300}) {
    std::vector<TickRecord> ticks;
    AddTicks(ticks, 1000, Phase::kHaptic);
    AddTicks(ticks, 80, Phase::kStopping);
    AddTicks(ticks, paused, Phase::kWaiting);
    AddTicks(ticks, 1000, Phase::kHaptic);
    ticks[1000].input.pause = true;
    const std::vector<session::StopRecord> stops = FindStops(ticks);
    ASSERT_EQ(stops.size(), 1u);
    EXPECT_EQ(stops[0].ticks[stops[0].rest].tick, 1080u);
    EXPECT_EQ(stops[0].ticks.back().tick, paused == 300 ? 1379u : 1080u + 500u);
    EXPECT_STREQ(stops[0].Heading(), "How the pause began");
    EXPECT_TRUE(stops[0].IsPause());
  }
}

// In stop category 0 the arm is not under the controller's command. Therefore the record counts the arm as
// resting only from the end of this state on.
TEST(StopRecords, AfterStopCategoryZeroRestBeginsWhenTheArmStands) {
  std::vector<TickRecord> ticks;
  AddTicks(ticks, 1000, Phase::kHaptic);
  AddTicks(ticks, 1500, Phase::kStopped, Bit(Fault::kSession));
  for (std::size_t i = 1000; i < 1400; ++i)
    ticks[i].cell_state = static_cast<std::uint8_t>(safety::CellState::kStop0);
  const std::vector<session::StopRecord> stops = FindStops(ticks);
  ASSERT_EQ(stops.size(), 1u);
  EXPECT_EQ(stops[0].ticks[stops[0].rest].tick, 1400u);
  EXPECT_EQ(stops[0].ticks.back().tick, 1400u + 500u);
}

// A loop that never comes to rest must not use unbounded memory.
TEST(StopRecords, HoldALimitedNumberOfTicks) {
  std::vector<TickRecord> ticks;
  AddTicks(ticks, 30'000, Phase::kHaptic);
  // all ticks fall within the five seconds that a record keeps
  for (TickRecord& tick : ticks) tick.stamp = 0;
  AddTicks(ticks, 30'000, Phase::kStopping);
  const std::vector<session::StopRecord> stops = FindStops(ticks);
  ASSERT_EQ(stops.size(), 1u);
  EXPECT_EQ(stops[0].ticks[stops[0].stop].tick, 30'000u);
  EXPECT_LE(stops[0].ticks.size(), 2 * session::StopFinder::kMaxTicks);
}

TEST(StopRecords, NameAPauseAsTheCause) {
  std::vector<TickRecord> ticks;
  AddTicks(ticks, 100, Phase::kHaptic);
  AddTicks(ticks, 50, Phase::kStopping);
  EXPECT_EQ(FindStops(ticks).at(0).DescribeCause(), "the arm ended the session");
  ticks[100].input.pause = true;
  EXPECT_EQ(FindStops(ticks).at(0).DescribeCause(), "a pause was asked for");
}

// A slow tool stops within one tick, so no tick of this pause has the phase kStopping.
TEST(StopRecords, FindThePauseOfASlowTool) {
  std::vector<TickRecord> ticks;
  AddTicks(ticks, 100, Phase::kHaptic);
  AddTicks(ticks, 700, Phase::kWaiting);
  EXPECT_TRUE(FindStops(ticks).empty());
  for (std::size_t i = 100; i < ticks.size(); ++i)
    ticks[i].cell_state = static_cast<std::uint8_t>(safety::CellState::kPaused);
  const std::vector<session::StopRecord> stops = FindStops(ticks);
  ASSERT_EQ(stops.size(), 1u);
  EXPECT_TRUE(stops[0].IsPause());
  EXPECT_EQ(stops[0].ticks[stops[0].rest].tick, 100u);
  EXPECT_EQ(stops[0].ticks.back().tick, 600u);
}

TEST(StopRecords, ARunThatNeverMovedHasNoStops) {
  std::vector<TickRecord> ticks;
  EXPECT_TRUE(FindStops(ticks).empty());
  AddTicks(ticks, 100, Phase::kWaiting);
  AddTicks(ticks, 100, Phase::kStopped, Bit(Fault::kPeriod));
  EXPECT_TRUE(FindStops(ticks).empty());
}

TEST(StopRecords, AreEachAPageAndATableThatReplaceAnEarlierRuns) {
  const TemporaryFolder folder;
  std::vector<TickRecord> ticks = TwoStops();
  const auto pages =
      WriteStops(ticks, folder.path(),
                 {{0, "fault: motion not permitted"}, {1, "end: 4 s of rendering were over"}, {2, "depth"}});
  ASSERT_TRUE(pages) << pages.error();
  ASSERT_EQ(pages->size(), 2u);
  const std::string page = io::test::ReadAll(pages->front().page);
  for (const char* part :
       {"Stop no. 1: arm left COMMANDING_ACTIVE; motion not permitted",
        "8.500 s into the recording, tick 8500",
        "Shown are 5.0 s before it and 0.6 s after. The arm was at rest from 0.100 s on; 0.5 s of that are "
        "shown.",
        "<h2>What led to the stop</h2>", "Age of the PLC", "State of the arm",
        "time since the stop began [s]", "the PLC withdrew its permission", "limit 150 N",
        "<pre>osteon view demo.mcap --at 7.5</pre>",
        "<a href=\"./demo_stop_1_ticks.csv\">demo_stop_1_ticks.csv</a>", "</html>"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_EQ(pages->front().heading, "What led to the stop");
  EXPECT_EQ(pages->front().ticks, folder.path() / "demo_stop_1_ticks.csv");
  EXPECT_EQ(report::MarkupError(page), "");

  // the second page reports the end of the run, which is not a fault
  const std::string end = io::test::ReadAll(pages->back().page);
  for (const char* part : {"<h1>How the run ended: 4 s of rendering were over</h1>",
                           "<h2>How the run ended</h2>", "No fault: 4 s of rendering were over.",
                           "at rest from 0.050 s on; 0.0 s of that are shown: there the recording ends."})
    EXPECT_NE(end.find(part), std::string::npos) << part;
  EXPECT_EQ(end.find("What led to the stop"), std::string::npos);
  EXPECT_EQ(pages->back().heading, "How the run ended");
  const std::string table = io::test::ReadAll(folder.path() / "demo_stop_1_ticks.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 1 + 9101 - 3500);

  ticks.resize(9000);
  ASSERT_TRUE(WriteStops(ticks, folder.path()));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "demo_stop_1.html"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "demo_stop_2.html")) << "nobody asked to remove it";
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "demo_stop_2_ticks.csv"));
}

// The page must say which part of the stop the recording does not show, and why.
TEST(StopRecords, SayWhyTheArmIsNotShownAtRest) {
  const TemporaryFolder folder;
  const auto page_of = [&](const std::vector<TickRecord>& ticks) {
    const auto pages = WriteStops(ticks, folder.path());
    return pages && pages->size() == 1 ? io::test::ReadAll(pages->front().page) : std::string();
  };
  std::vector<TickRecord> ticks;
  AddTicks(ticks, 100, Phase::kHaptic);
  AddTicks(ticks, 50, Phase::kStopping, Bit(Fault::kWorkspace));
  EXPECT_NE(page_of(ticks).find("ends while the arm was not at rest yet"), std::string::npos);
  ticks.back().input.received = static_cast<std::uint8_t>(control::ReceiveResult::kTimeout);
  EXPECT_NE(page_of(ticks).find("it sent no message any more"), std::string::npos);
  AddTicks(ticks, 200, Phase::kStopped, Bit(Fault::kWorkspace));
  EXPECT_NE(page_of(ticks).find("0.2 s of that are shown: there the recording ends"), std::string::npos);
}

TEST(StopRecords, AMissingFolderIsNamed) {
  const auto pages = WriteStops(TwoStops(), "/nowhere");
  ASSERT_FALSE(pages);
  EXPECT_NE(pages.error().find("/nowhere/demo_stop_1_ticks.csv"), std::string::npos) << pages.error();
}

// The documented table must equal the one that the code prints.
TEST(FaultCatalogue, EqualsTheDocumentedPage) {
  EXPECT_EQ(io::test::ReadAll(std::filesystem::path(OSTEON_SOURCE_DIR) / "docs/faults.md"), FaultsPage())
      << "osteon faults --markdown docs/faults.md";
}

TEST(StateMachine, EqualsTheDocumentedPage) {
  EXPECT_EQ(io::test::ReadAll(std::filesystem::path(OSTEON_SOURCE_DIR) / "docs/states.md"), StatesPage())
      << "osteon states --markdown docs/states.md";
}

TEST(StateMachine, IsPrintedAndWrittenAsJson) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"states", "--json", "s.json"});
  EXPECT_EQ(run.exit_code, 0) << run.out;
  const auto json = nlohmann::json::parse(io::test::ReadAll(folder.path() / "s.json"));
  EXPECT_EQ(json["schema"], "osteon.states/1");
  EXPECT_EQ(json["states"].size(), static_cast<std::size_t>(safety::kCellStates));
  EXPECT_EQ(json["transitions"].size(), static_cast<std::size_t>(safety::kCellStates * safety::kCellEvents));
  EXPECT_NE(run.out.find("pause asked    -> stop 2: brakes"), std::string::npos) << run.out;
}

TEST(FaultCatalogue, IsPrintedAndWrittenAsJson) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"faults", "--json", "f.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("contact model stale\n  seen:  no frame"), std::string::npos) << run.out;
  const nlohmann::json json = ReadJson(folder.path() / "f.json");
  EXPECT_EQ(json.at("schema"), "osteon.faults/1");
  EXPECT_EQ(json.at("faults").size(), static_cast<std::size_t>(safety::kFaultCount));
  EXPECT_EQ(RunCommand(folder.path(), {"faults", "--json", "/nowhere/f.json"}).exit_code, 1);
}

}  // namespace
}  // namespace osteon::app
