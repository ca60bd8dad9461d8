#pragma once

#include <string>

namespace osteon::studies {

/// A figure of a run, and the smallest difference at which two runs count as different.
struct RunFigure {
  std::string name;  ///< "peak force to the hand"
  std::string key;   ///< "peak_force_N": in JSON
  std::string unit;
  double value{0.0};
  double least_difference{0.0};  ///< smaller differences, and this one, never count
  bool judged{true};             ///< false: a time that the machine took, which is shown but not judged
};

}  // namespace osteon::studies
