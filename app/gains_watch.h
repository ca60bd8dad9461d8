#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "config/cell_config.h"
#include "control/servo_loop.h"

namespace osteon::app {

/// A file of gains that may be saved again while the loop runs with it: `osteon run --gains`.
///
/// Look() belongs to the thread that looks after the run, never to the tick. Twice a second it looks at the
/// file's modification time. One that has changed, and has rested since the look before (an editor may still
/// be writing), is read and checked like the cell's own; the loop then goes to the new gains (GainRamp). What
/// is wrong is said, and the gains stay.
class GainsWatch {
 public:
  /// @param file  as it was read at the start; empty: nothing to look at
  /// @param notice  told in one line what was done, or what is wrong; may be empty
  GainsWatch(std::filesystem::path file, const config::CellConfig& cell, control::ServoLoop& loop,
             std::function<void(const std::string&)> notice);

  /// @param at_s  on any clock that does not go back
  void Look(double at_s);

 private:
  void Read();

  std::filesystem::path file_;
  const config::CellConfig& cell_;
  control::ServoLoop& loop_;
  std::function<void(const std::string&)> notice_;
  control::Gains asked_;                    ///< last
  std::filesystem::file_time_type read_{};  ///< modification times: of what was read,
  std::filesystem::file_time_type seen_{};  ///< and at the last look
  double next_s_{0.0};
};

}  // namespace osteon::app
