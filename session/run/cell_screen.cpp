#include "session/run/cell_screen.h"

#include <fmt/format.h>

#include "io/fri/session_name.h"

namespace osteon::session {
namespace {

using control::SessionState;
using io::SessionName;

// Time without traffic after which the screen says what the cell waits for.
constexpr double kPatience_s = 1.0;

}  // namespace

const char* RsiStateText(SessionState state) {
  switch (state) {
    case SessionState::kIdle:
      return "RSI is off";
    case SessionState::kMonitoringWait:
    case SessionState::kMonitoringReady:
      return "RSI is on, no answer yet";
    case SessionState::kCommandingWait:
      return "RSI is answered, without a correction so far";
    case SessionState::kCommandingActive:
      return "RSI is answered, the arm follows the corrections";
  }
  return "unknown";
}

CellScreen::CellScreen(const config::CellConfig& cell)
    : rsi_(cell.link.rsi() != nullptr),
      has_plc_(cell.devices.plc.has_value()),
      controller_(fmt::format("{}:{}", cell.guard ? cell.guard->host : cell.link.host,
                              cell.guard ? cell.guard->port : cell.link.port)) {
  if (has_plc_) plc_ = fmt::format("{}:{}", cell.devices.plc->address, cell.devices.plc->port);
}

std::vector<std::string> CellScreen::Lines(const hil::CellHostState& state, double now_s) {
  std::vector<std::string> lines;
  const hil::CellState& arm = state.arm.cell;
  if (arm.session != session_) {
    // while nobody answers, the arm's program restarts again and again: report its state only once
    if (arm.counters.answered > 0 || !told_) lines.push_back(SessionLine(state));
    told_ = true;
    session_ = arm.session;
  }
  if (state.arm.undelivered != undelivered_) {
    undelivered_ = state.arm.undelivered;
    last_undelivered_s_ = now_s;
  }
  if (arm.counters.answered != answered_) {
    answered_ = arm.counters.answered;
    last_answer_s_ = now_s;
    silence_.clear();
  }
  if (now_s - last_answer_s_ < kPatience_s) return lines;
  std::string silence = DescribeSilence(state, last_undelivered_s_ >= last_answer_s_);
  if (silence == silence_) return lines;
  silence_ = std::move(silence);
  lines.push_back(silence_);
  return lines;
}

// Formats the new state, "COMMANDING_ACTIVE". After a step back to an earlier state, adds the previous state
// and the reason for leaving it, if the arm knows the reason: "COMMANDING_ACTIVE -> MONITORING_WAIT: 5
// answers in a row lost, …".
std::string CellScreen::SessionLine(const hil::CellHostState& state) const {
  const hil::CellState& arm = state.arm.cell;
  const std::string now = rsi_ ? RsiStateText(arm.session) : SessionName(arm.session);
  if (arm.session > session_) return now;
  std::string why = hil::DescribeStop(arm);
  if (why == hil::kNoPower && has_plc_)
    why += ": the PLC took it (" + hil::DescribeBlocks(state.plc.blocks) + ")";
  const std::string before = rsi_ ? "" : std::string(SessionName(session_)) + " -> ";
  return before + now + (why.empty() ? "" : ": " + why);
}

// Says why nobody answers, as far as it is known from the arm and the PLC.
std::string CellScreen::DescribeSilence(const hil::CellHostState& state, bool comes_back) const {
  const hil::CellState& arm = state.arm.cell;
  std::string text;
  if (arm.counters.sent == 0)
    text = fmt::format("the arm has sent nothing yet ({})", rsi_ ? "RSI is off" : "its session is IDLE");
  else if (comes_back)
    text = fmt::format("no arm controller listens on {}: the arm's messages come back", controller_);
  else
    text = fmt::format("no arm controller answers the arm's messages to {}", controller_);
  if (has_plc_ && state.plc_counters.connections == 0)
    text += fmt::format("; no PLC master has connected to {} yet: the drives have no power", plc_);
  else if (has_plc_ && !state.plc.power_on)
    text += "; the drives have no power, the PLC withholds it: " + hil::DescribeBlocks(state.plc.blocks);
  return text;
}

}  // namespace osteon::session
