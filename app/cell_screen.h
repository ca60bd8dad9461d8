#pragma once

#include <string>
#include <vector>

#include "config/cell_config.h"
#include "hil/cell_host.h"

namespace osteon::app {

/// What RSI does in a state of hil::RsiArm: "RSI is on, no answer yet".
[[nodiscard]] const char* RsiStateText(control::SessionState state);

/// What `osteon cell` says while it runs, beyond where its wires are: each new state of the arm's session and
/// why the last one was left, and, once a second has passed in which nothing came, what it waits for: an arm
/// controller that answers, a PLC master.
///
/// An arm on FRI is told of in FRI's session states, one on RSI in what RSI does.
class CellScreen {
 public:
  explicit CellScreen(const config::CellConfig& cell);

  /// A line for each thing that is new since the call before. @param now_s  since the cell began
  [[nodiscard]] std::vector<std::string> Lines(const hil::CellHostState& state, double now_s);

 private:
  [[nodiscard]] std::string SessionLine(const hil::CellHostState& state) const;
  [[nodiscard]] std::string Silence(const hil::CellHostState& state, bool comes_back) const;

  bool rsi_, has_plc_;
  std::string controller_, plc_;  // address and port
  control::SessionState session_{control::SessionState::kIdle};
  bool told_{false};  // of a state, before anybody has answered
  std::uint64_t answered_{0}, undelivered_{0};
  double last_answer_s_{0.0}, last_undelivered_s_{-1.0};
  std::string silence_;  // as said last
};

}  // namespace osteon::app
