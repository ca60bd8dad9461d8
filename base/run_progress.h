#pragma once

#include <string>
#include <string_view>

#include "base/clock.h"

namespace osteon::base {

/// Shows a run's progress on stderr: a bar on a terminal, elsewhere a line for each tenth. Without an end:
/// the time.
class RunProgress {
 public:
  /// @param name  the command's  @param seconds  of the run; 0: no end
  RunProgress(std::string name, double seconds);
  void Show(double at_s);
  /// The same with a line that says more than the time: on a terminal in place of the bar, elsewhere after
  /// the time.
  void Show(double at_s, std::string_view status);
  /// Columns for a status line on this terminal; 200 elsewhere.
  [[nodiscard]] static std::size_t StatusColumns();
  /// Removes the bar.
  void Done() const;

 private:
  std::string name_;
  double seconds_;
  bool terminal_;
  double next_;
  rt::Nanoseconds shown_{0};
};

}  // namespace osteon::base
