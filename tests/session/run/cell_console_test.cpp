// The page of `osteon cell`, which simulates a cell for a controller in another process: the page shows the
// arm, its hand and its spindle.

#include "session/run/cell_console.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "config/reading/load.h"
#include "safety/cell_state.h"

namespace osteon::session {
namespace {

using testing::HasSubstr;

TEST(CellConsole, ShowsTheArmsCycleAndNothingThatOnlyAControllerKnows) {
  hil::CellState cycle;
  cycle.cycle = 7;
  cycle.stamp = 70;
  cycle.session = control::SessionState::kCommandingActive;
  cycle.q_meas = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};
  cycle.X_WT_meas.p = Vector3(0.1, -0.2, 0.3);
  cycle.v_WT_meas_m_per_s = Vector3(0.0, 0.0, -0.02);
  cycle.F_hand_T_W.f = Vector3(0.0, 0.0, -12.0);
  const control::TickRecord record = RecordOf(cycle, 26.0);
  EXPECT_EQ(record.stamp, 70);
  EXPECT_EQ(record.session_state, 4);
  EXPECT_EQ(record.q_meas[6], 0.7);
  EXPECT_EQ(record.X_WT_cmd.p.y, -0.2);
  EXPECT_EQ(record.F_operator_T_W.f.z, -12.0);
  EXPECT_EQ(record.input.spindle_meas_rad_per_s, 26.0);
  EXPECT_EQ(record.cell_state, control::kNoCellState);

  console::LiveFeed feed;
  feed.TakeTick(record);
  feed.Flush();
  const console::LiveStatus status = console::StatusOf(feed.Newest(), {});
  EXPECT_TRUE(status.known);
  EXPECT_EQ(status.hand_N, 12.0);
  EXPECT_EQ(status.speed_mm_per_s, 20.0);
  EXPECT_TRUE(status.permits.empty()) << "no state machine, no conditions";
  EXPECT_FALSE(status.can_pause || status.can_resume || status.can_recover);
}

TEST(CellConsole, TheNoteHasTheArmsSessionAndWhyThereIsNoPower) {
  hil::CellHostState state;
  state.arm.cell.session = control::SessionState::kMonitoringReady;
  state.arm.cell.counters.sent = 1000;
  state.plc.blocks = static_cast<std::uint16_t>(hil::PlcBlock::kNotRequested);
  const auto note = nlohmann::json::parse(CellNote(state, false));
  EXPECT_EQ(note.at("type"), "cell");
  EXPECT_EQ(note.at("session"), "MONITORING_READY");
  EXPECT_FALSE(note.at("commanded"));
  EXPECT_FALSE(note.at("power_on"));
  EXPECT_THAT(note.at("blocks").get<std::string>(), HasSubstr("not requested"));
  EXPECT_EQ(note.at("sent"), 1000);
  EXPECT_THAT(nlohmann::json::parse(CellNote(state, true)).at("session").get<std::string>(),
              HasSubstr("RSI is on"));
}

TEST(CellConsole, ServesThePageWithoutABoneAndRefusesATakenPort) {
  const config::CellConfig cell = config::LoadCell(OSTEON_SOURCE_DIR "/config/cells/molar.yaml");
  const ConsoleChoice any_port{.port = 0, .only_this_port = true};
  const auto page = CellConsole::Open(any_port, cell, "molar", 3.0);
  ASSERT_TRUE(page) << page.error();
  EXPECT_THAT((*page)->url(), HasSubstr("http://127.0.0.1:"));
  (*page)->TakeCycle({});
  (*page)->Show({}, {"MONITORING_WAIT"});
  ConsoleChoice taken{.only_this_port = true};
  const std::string url = (*page)->url();
  taken.port = std::stoi(url.substr(url.rfind(':') + 1));
  const auto second = CellConsole::Open(taken, cell, "molar", 3.0);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error(), HasSubstr(std::to_string(taken.port)));
}

}  // namespace
}  // namespace osteon::session
