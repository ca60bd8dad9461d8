#pragma once

#include <string>
#include <string_view>

#include "base/clock.h"

namespace osteon::base {

/// Shows a run's progress on stderr. A terminal shows a bar; a file or a pipe gets a line for each tenth of
/// the run. A run without an end has no bar: its elapsed time is shown, in a file or a pipe every 10 s.
class RunProgress {
 public:
  /// @param name  name of the command  @param seconds  duration of the run; 0: it has no end
  RunProgress(std::string name, double seconds);
  void Show(double at_s);
  /// Shows a status line in place of the bar or of the elapsed time.
  void Show(double at_s, std::string_view status);
  /// Number of columns for a status line: those of the terminal; 200 if stderr is no terminal.
  [[nodiscard]] static std::size_t StatusColumns();
  /// Removes the bar.
  void Done() const;

 private:
  std::string name_;
  double seconds_;
  bool terminal_;
  double next_;  ///< time of the next line: as a share of the run, or in seconds if the run has no end
  rt::Nanoseconds shown_{0};  ///< time of the last status line
};

}  // namespace osteon::base
