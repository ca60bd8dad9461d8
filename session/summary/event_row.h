#pragma once

#include <string>

namespace osteon::session {

/// An event of the scene (simulation::SceneEvent), or an operator's pause or its end, timed from the run's
/// start.
struct EventRow {
  std::string name;
  double time_s{0.0};
  double value{0.0};  ///< the event's value, in `unit`
  std::string unit;
};

}  // namespace osteon::session
