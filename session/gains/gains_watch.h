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
/// The thread that supervises the run calls Poll(), never the tick. Twice a second Poll reads the file's
/// modification time. The file is read if this time differs from that of the last read and has not changed
/// since the previous poll (otherwise an editor may still be writing). The file is checked like the cell's
/// own gains, and the loop ramps to the new gains (GainRamp). After an error, which is reported, the gains
/// stay unchanged.
class GainsWatch {
 public:
  /// @param file  the gains file that was read at the start; empty: there is no file to watch
  /// @param notice  called with one line about a change or an error; may be empty
  /// @param panel  source of the gains that pages ask for; null: pages cannot ask for gains
  GainsWatch(std::filesystem::path file, const config::CellConfig& cell, control::ServoLoop& loop,
             std::function<void(const std::string&)> notice, GainsPanel* panel = nullptr);

  /// Looks for new gains. @param at_s  present time, by any clock that does not go back
  void Poll(double at_s);

 private:
  void Read();
  void Request(const control::Gains& gains);

  std::filesystem::path file_;
  const config::CellConfig& cell_;
  control::ServoLoop& loop_;
  std::function<void(const std::string&)> notice_;
  GainsPanel* panel_;
  control::Gains asked_;                    ///< the gains last passed to the loop
  std::filesystem::file_time_type read_{};  ///< the file's modification time when its content was last read
  std::filesystem::file_time_type seen_{};  ///< the file's modification time at the last poll
  double next_s_{0.0};
};

}  // namespace osteon::session
