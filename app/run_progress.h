#pragma once

#include <string>

namespace osteon::app {

/// How far a run is, on stderr: a bar on a terminal, a line each tenth elsewhere. A run without an end shows
/// its time.
class RunProgress {
 public:
  /// @param name  the command's  @param seconds  of the run; 0: no end
  RunProgress(std::string name, double seconds);
  void Show(double at_s);
  /// Takes the bar away.
  void Done() const;

 private:
  std::string name_;
  double seconds_;
  bool terminal_;
  double next_;
};

}  // namespace osteon::app
