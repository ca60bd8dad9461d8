#pragma once

#include <string>
#include <string_view>

#include "base/clock.h"

namespace osteon::base {

/// Shows a run's progress on stderr: a bar on a terminal, elsewhere a line for each tenth of the run. For a
/// run without an end, it shows the time; if stderr is no terminal, every 10 s.
class RunProgress {
 public:
  /// @param name  name of the command  @param seconds  duration of the run; 0: it has no end
  RunProgress(std::string name, double seconds);
  void Show(double at_s);
  /// Shows the progress with a status line, which takes the place of the bar or of the time.
  void Show(double at_s, std::string_view status);
  /// Columns for a status line on this terminal; 200 elsewhere.
  [[nodiscard]] static std::size_t StatusColumns();
  /// Removes the bar.
  void Done() const;

 private:
  std::string name_;
  double seconds_;
  bool terminal_;
  double next_;               ///< when the next line is due: share of the run, or seconds if it has no end
  rt::Nanoseconds shown_{0};  ///< time of the last status line
};

}  // namespace osteon::base
