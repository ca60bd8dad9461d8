#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "config/reading/cell_config.h"
#include "control/loop/servo_loop.h"

namespace osteon::session {

class GainsPanel;

/// Watches the gains file of `osteon run --gains`, which may be saved again during the run, and takes the
/// gains that the console's pages ask for (GainsPanel).
///
/// Poll() belongs to the thread that supervises the run, never to the tick. Twice a second it reads the
/// file's modification time. Once that time differs from the one at the last read, and has not changed for
/// one poll (an editor may still be writing), the file is read and checked like the cell's own gains, and the
/// loop ramps to the new gains (GainRamp). An error is reported, and the gains stay.
class GainsWatch {
 public:
  /// @param file  the one that was read at the start; empty: there is no file to watch
  /// @param notice  called with one line about a change or an error; may be empty
  /// @param panel  has the gains that pages ask for; null: pages cannot ask
  GainsWatch(std::filesystem::path file, const config::CellConfig& cell, control::ServoLoop& loop,
             std::function<void(const std::string&)> notice, GainsPanel* panel = nullptr);

  /// Looks for new gains. @param at_s  time of any clock that does not go back
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
