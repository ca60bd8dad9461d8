#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "config/reading/cell_config.h"
#include "control/loop/servo_loop.h"

namespace osteon::session {

class GainsPanel;

/// Watches a file of gains that may be saved again while the loop runs with it: `osteon run --gains`; and
/// takes what the console's pages ask for (GainsPanel).
///
/// Poll() belongs to the thread that supervises the run, never to the tick. Twice a second it reads the
/// file's modification time. Once the file is newer than when it was read, and has not changed for one poll
/// (an editor may still be writing), it is read and checked like the cell's own, and the loop ramps to the
/// new gains (GainRamp). An error is reported, and the gains stay.
class GainsWatch {
 public:
  /// @param file  as read at the start; empty: nothing to watch
  /// @param notice  called with one line about a change or an error; may be empty
  /// @param panel  what pages ask for; null: none
  GainsWatch(std::filesystem::path file, const config::CellConfig& cell, control::ServoLoop& loop,
             std::function<void(const std::string&)> notice, GainsPanel* panel = nullptr);

  /// @param at_s  of any clock that does not go back
  void Poll(double at_s);

 private:
  void Read();
  void Request(const control::Gains& gains);

  std::filesystem::path file_;
  const config::CellConfig& cell_;
  control::ServoLoop& loop_;
  std::function<void(const std::string&)> notice_;
  GainsPanel* panel_;
  control::Gains asked_;                    ///< the gains last given to the loop
  std::filesystem::file_time_type read_{};  ///< modification time of the file as last read
  std::filesystem::file_time_type seen_{};  ///< modification time at the last poll that read it
  double next_s_{0.0};
};

}  // namespace osteon::session
