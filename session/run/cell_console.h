#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "config/reading/cell_config.h"
#include "console/server/console_server.h"
#include "console/stream/live_feed.h"
#include "hil/cell_host.h"
#include "session/run/live_views.h"

namespace osteon::session {

/// The page of `osteon cell`: the true motion of the simulated arm, its operator's hand, its spindle, and the
/// permissions of PLC and arm. It shows neither bone nor coupling, which only the controller knows; the
/// controller's run has a page of its own. The page accepts no requests: the cell's script presses the
/// buttons.
///
///     cycles of the arm ──TakeCycle──▶ LiveFeed ──▶ pages
///     state of the cell ──Show───────▶ a note, sent when it changes
class CellConsole {
 public:
  /// @param cell  the cell's name. The error names address and port, and says what to do.
  [[nodiscard]] static tl::expected<std::unique_ptr<CellConsole>, std::string> Open(
      const ConsoleChoice& choice, const config::CellConfig& config, const std::string& cell, double seconds);

  /// Takes the next cycle of the arm. Call it from one thread only.
  void TakeCycle(const hil::CellState& cycle);
  /// Takes the newest state, and the lines that the screen prints about it. Call it from the thread of
  /// TakeCycle.
  void Show(const hil::CellHostState& state, const std::vector<std::string>& lines);
  [[nodiscard]] std::string url() const { return server_->url(); }

 private:
  explicit CellConsole(bool rsi) : rsi_(rsi) {}
  [[nodiscard]] std::string Note();

  bool rsi_;                       // the arm is connected by RSI, not by FRI
  double spindle_rad_per_s_{0.0};  // spindle speed in the newest state
  rt::Nanoseconds stamp_{0};       // stamp of the newest cycle
  console::LiveFeed feed_;
  console::SurfaceStore surface_;                   // stays empty
  std::mutex mutex_;                                // guards note_
  std::string note_;                                // the newest state, as the message for the pages
  std::unique_ptr<console::ConsoleServer> server_;  // declared last: its threads use the other members
};

/// Makes the message for the pages, {"type": "cell", …}; console/web/src/messages.ts has its fields.
/// @param rsi  the arm is connected by RSI, not by FRI
[[nodiscard]] std::string CellNote(const hil::CellHostState& state, bool rsi);

/// Makes a tick record for the pages from a cycle of the simulated arm. The true pose takes the place of the
/// commanded one; the controller's fields (state, coupling, limits) are absent. @param spindle_rad_per_s
/// measured spindle speed
[[nodiscard]] control::TickRecord RecordOf(const hil::CellState& cycle, double spindle_rad_per_s);

}  // namespace osteon::session
