// The lines that `osteon cell` prints while it simulates a cell: the arm's session, and what the cell waits
// for.

#include "session/run/cell_screen.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/reading/load.h"

namespace osteon::session {
namespace {

using control::SessionState;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

config::CellConfig Cell(const std::string& name) {
  return config::LoadCell(OSTEON_SOURCE_DIR "/config/cells/" + name + ".yaml");
}

// A host with power and a connected PLC master. @param sent, answered  numbers of the arm's messages and
// answers
hil::CellHostState State(SessionState session, std::uint64_t sent = 1000, std::uint64_t answered = 0) {
  hil::CellHostState state;
  state.arm.cell.session = session;
  state.arm.cell.counters.sent = sent;
  state.arm.cell.counters.answered = answered;
  state.plc_counters.connections = 1;
  state.plc.power_on = true;
  return state;
}

TEST(CellScreen, SaysWhyNothingHappensOncePerReason) {
  CellScreen screen(Cell("thin_plate"));
  hil::CellHostState state = State(SessionState::kMonitoringWait);
  state.plc_counters.connections = 0;
  state.plc.power_on = false;
  EXPECT_THAT(screen.Lines(state, 0.1), ElementsAre("MONITORING_WAIT"));
  EXPECT_THAT(screen.Lines(state, 0.9), IsEmpty()) << "a controller may be on its way";
  state.arm.undelivered = 7;
  EXPECT_THAT(
      screen.Lines(state, 1.1),
      ElementsAre("no arm controller listens on 127.0.0.1:30200: the arm's messages come back; no PLC "
                  "master has connected to 127.0.0.1:1502 yet: the drives have no power"));
  state.arm.undelivered = 9;
  EXPECT_THAT(screen.Lines(state, 3.0), IsEmpty()) << "it is said once";
  state.plc_counters.connections = 1;
  state.plc.blocks = static_cast<std::uint16_t>(hil::PlcBlock::kNotRequested);
  EXPECT_THAT(screen.Lines(state, 3.1),
              ElementsAre(HasSubstr("the drives have no power, the PLC withholds it: not requested")));
  state.arm.cell.counters.answered = 1;
  EXPECT_THAT(screen.Lines(state, 3.2), IsEmpty());
}

TEST(CellScreen, TellsAControllerThatDoesNotAnswerFromAnArmThatSendsNothing) {
  CellScreen screen(Cell("thin_plate"));
  EXPECT_THAT(
      screen.Lines(State(SessionState::kMonitoringWait), 2.0),
      ElementsAre("MONITORING_WAIT", "no arm controller answers the arm's messages to 127.0.0.1:30200"));
  CellScreen silent(Cell("thin_plate"));
  EXPECT_THAT(silent.Lines(State(SessionState::kIdle, 0), 2.0),
              ElementsAre("the arm has sent nothing yet (its session is IDLE)"));
}

TEST(CellScreen, SaysWhyASessionWasLeft) {
  CellScreen screen(Cell("thin_plate"));
  EXPECT_THAT(screen.Lines(State(SessionState::kCommandingActive, 10, 10), 0.1),
              ElementsAre("COMMANDING_ACTIVE"));
  hil::CellHostState state = State(SessionState::kMonitoringWait, 20, 15);
  state.arm.cell.stop = {.reason = hil::StopReason::kLostInARow, .found = 5, .accepted = 5};
  EXPECT_THAT(screen.Lines(state, 0.2),
              ElementsAre("COMMANDING_ACTIVE -> MONITORING_WAIT: 5 answers in a row lost, the arm ends "
                          "commanding at 5"));
  EXPECT_THAT(screen.Lines(State(SessionState::kCommandingActive, 30, 25), 0.3),
              ElementsAre("COMMANDING_ACTIVE"));
  state = State(SessionState::kMonitoringReady, 40, 35);
  state.arm.cell.stop.reason = hil::StopReason::kPowerOff;
  state.plc.blocks = static_cast<std::uint16_t>(hil::PlcBlock::kControllerLost);
  EXPECT_THAT(screen.Lines(state, 0.4),
              ElementsAre("COMMANDING_ACTIVE -> MONITORING_READY: the drives have no power: the PLC took it "
                          "(controller's heartbeat lost)"));
}

// A KR is connected by RSI and has none of FRI's states.
TEST(CellScreen, ShowsAKrByItsRsiStates) {
  CellScreen screen(Cell("kr_16_thin_plate"));
  std::string all;
  const auto append_lines = [&](const hil::CellHostState& state, double now_s) {
    for (const std::string& line : screen.Lines(state, now_s)) all += line + "\n";
  };
  append_lines(State(SessionState::kMonitoringWait), 0.1);
  hil::CellHostState off = State(SessionState::kIdle);
  off.arm.cell.rsi_stop = {.reason = hil::RsiStopReason::kTimeout, .found = 100, .accepted = 100};
  for (int again = 0; again < 5; ++again) {  // nobody answers: the program restarts repeatedly
    append_lines(off, 0.2);
    append_lines(State(SessionState::kMonitoringWait), 0.3);
  }
  append_lines(State(SessionState::kCommandingWait, 1000, 1), 0.4);
  append_lines(State(SessionState::kCommandingActive, 1010, 11), 0.5);
  off.arm.cell.counters.answered = 20;
  append_lines(off, 0.6);
  EXPECT_EQ(all,
            "RSI is on, no answer yet\n"
            "RSI is answered, without a correction so far\n"
            "RSI is answered, the arm follows the corrections\n"
            "RSI is off: timeout: 100 answers late, RSI ends at 100\n");
}

}  // namespace
}  // namespace osteon::session
