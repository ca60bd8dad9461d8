#pragma once

#include <string>
#include <vector>

#include "config/reading/cell_config.h"
#include "hil/cell_host.h"

namespace osteon::session {

/// Says in words what RSI does in a state of hil::RsiArm: "RSI is on, no answer yet".
[[nodiscard]] const char* RsiStateText(control::SessionState state);

/// Makes the lines that `osteon cell` prints while it runs: each new state of the arm's session with the
/// reason for leaving the last one, and, after a second without traffic, what the cell waits for: a
/// controller that answers the arm's messages, or a PLC master that connects.
///
/// With FRI, the lines name FRI's session states. With RSI, they say what RSI does (RsiStateText).
class CellScreen {
 public:
  explicit CellScreen(const config::CellConfig& cell);

  /// Returns a line for each change since the last call. @param now_s  since the cell began
  [[nodiscard]] std::vector<std::string> Lines(const hil::CellHostState& state, double now_s);

 private:
  [[nodiscard]] std::string SessionLine(const hil::CellHostState& state) const;
  // @param comes_back  the arm's messages are rejected: no program listens on the controller's port
  [[nodiscard]] std::string DescribeSilence(const hil::CellHostState& state, bool comes_back) const;

  bool rsi_, has_plc_;
  std::string controller_, plc_;  // address and port of the controller and of the PLC
  control::SessionState session_{control::SessionState::kIdle};
  bool told_{false};                                      // a state was printed before anybody answered
  std::uint64_t answered_{0}, undelivered_{0};            // counts of the arm's messages at the last call
  double last_answer_s_{0.0}, last_undelivered_s_{-1.0};  // times at which these counts last rose
  std::string silence_;                                   // line about the silence that was printed last
};

}  // namespace osteon::session
