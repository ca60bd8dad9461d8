#pragma once

#include <string>

namespace osteon::app {

/// Shows a run's progress on stderr: a bar on a terminal, elsewhere a line for each tenth. Without an end:
/// the time.
class RunProgress {
 public:
  /// @param name  the command's  @param seconds  of the run; 0: no end
  RunProgress(std::string name, double seconds);
  void Show(double at_s);
  /// Removes the bar.
  void Done() const;

 private:
  std::string name_;
  double seconds_;
  bool terminal_;
  double next_;
};

}  // namespace osteon::app
