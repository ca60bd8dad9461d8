#pragma once

#include <cstddef>
#include <vector>

namespace osteon::gpu {

/// Pins each worker thread of a driver that computes on the processor (lavapipe) to its own core.
///
/// Such a driver wakes all its workers at once for every dispatch. They sleep only for microseconds, and
/// Linux does not migrate threads for so short a sleep. Two of them may therefore share one core for a whole
/// run, and every frame then takes up to 1.8 times as long. Workers are recognised by their start: while the
/// device opens, after the driver's named rasterizers, in equal number and without a name of their own. Where
/// this does not match (another driver, a second device of the process, fewer cores than workers) nothing is
/// changed.
class DriverThreads {
 public:
  /// Create before the device opens.
  DriverThreads();

  /// Call once the device is open; waits at most 30 ms for its threads' names. @returns the number of pinned
  /// threads.
  int PinWorkers() const;

 private:
  /// The driver's threads that have begun since construction.
  struct Begun {
    std::size_t rasterizers{0}, unnamed{0};
    std::vector<int> workers;  ///< unnamed threads after as many rasterizers, at most their number
  };
  [[nodiscard]] Begun FindWorkers() const;

  std::vector<int> before_;  ///< ids of the threads at construction, sorted
};

}  // namespace osteon::gpu
