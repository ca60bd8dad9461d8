#pragma once

#include <cstddef>
#include <vector>

namespace osteon::gpu {

/// Gives each worker thread of a driver that computes on the processor (lavapipe) a core of its own.
///
/// Such a driver wakes all its workers at once for every dispatch. They sleep for microseconds only, and
/// Linux, which moves no thread for so short a rest, can leave two of them on one core for a whole run: every
/// frame then takes up to 1.8 times as long. Workers are known by when they begin: while the device opens,
/// after the driver's named rasterizers and as many as these, without a name of their own. Where that does
/// not fit (another driver, a second device of the process, fewer cores than workers) nothing is changed.
class DriverThreads {
 public:
  /// Before the device opens.
  DriverThreads();

  /// Once it is open; waits 30 ms at most for its threads' names. @returns how many threads
  /// were given a core.
  int Spread() const;

 private:
  struct Begun {
    std::size_t rasterizers{0}, unnamed{0};
    std::vector<int> workers;  ///< unnamed ones after as many rasterizers, as many as these at most
  };
  [[nodiscard]] Begun Look() const;

  std::vector<int> before_;  ///< thread ids, sorted
};

}  // namespace osteon::gpu
