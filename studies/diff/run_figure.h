#pragma once

#include <string>

namespace osteon::studies {

/// A figure of a run, with the difference from which two runs count as different.
struct RunFigure {
  std::string name;  ///< "peak force to the hand"
  std::string key;   ///< "peak_force_N": in JSON
  std::string unit;
  double value{0.0};
  double least_difference{0.0};  ///< differences up to this never count
  bool judged{true};             ///< false: a time that the machine took; shown, not judged
};

}  // namespace osteon::studies
