#pragma once

#include <cstddef>
#include <vector>

namespace osteon::gpu {

/// Pins each worker thread of a driver that computes on the processor (lavapipe) to its own core.
///
/// Such a driver wakes all its worker threads at once for every dispatch. The workers sleep only for
/// microseconds between dispatches, and Linux does not migrate threads for so short a sleep. Two workers may
/// therefore share one core for a whole run, and every frame then takes up to 1.8 times as long. Workers are
/// recognised by how they start: while the device opens, after the driver's named rasterizer threads, as many
/// as these, and without a name of their own. If the threads do not match this pattern (another driver, a
/// second device of the process) or there are fewer cores than workers, nothing is changed.
class DriverThreads {
 public:
  /// Create before the device opens.
  DriverThreads();

  /// Call once the device is open; waits at most 30 ms until the driver's threads have their names. @returns
  /// the number of pinned threads.
  int PinWorkers() const;

 private:
  /// The driver's threads that have begun since construction.
  struct Begun {
    std::size_t rasterizers{0}, unnamed{0};
    /// Unnamed threads that follow the rasterizers in the list; at most as many as rasterizers.
    std::vector<int> workers;
  };
  [[nodiscard]] Begun FindWorkers() const;

  std::vector<int> before_;  ///< ids of the threads at construction, sorted
};

}  // namespace osteon::gpu
