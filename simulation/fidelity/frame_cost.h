#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace osteon::simulation {

/// One timed frame.
struct FrameSample {
  double us{0.0};
  double active_balls{0.0};  ///< that the engine worked on
  double waited_us{0.0};     ///< for a processor, all its threads together
};

/// Frames of one packing.
struct FrameGroup {
  std::size_t frames{0};
  std::size_t interrupted{0};  ///< that waited for more than 20 us and 5 % of the median frame
  double active_balls{0.0};    ///< median
  double p50_us{0.0};          ///< of all frames
  double p999_us{0.0};         ///< of those that were not interrupted, or of all where there is none
};

/// The median is of all frames: the threads of a driver that computes on the processor wait for each other,
/// so that frames without a wait are few and odd ones (on two cores their median was up to five times that of
/// all). p99.9: by nearest rank.
/// @throws std::invalid_argument where there is no frame.
[[nodiscard]] FrameGroup GroupOf(std::span<const FrameSample> samples);

/// What a frame costs on a machine, with one tool:
///
///     t = t0 + c N,   N active balls;   t0, c >= 0
struct FrameCost {
  double base_us{0.0}, ball_us{0.0};
  double tail_ratio{1.0};  ///< p99.9 over median
  [[nodiscard]] double At(double active_balls) const { return base_us + ball_us * active_balls; }
};

/// Least squares of the groups' medians, relative to each; tail: the groups' median ratio.
/// @throws std::invalid_argument where there are fewer than two groups, or a median is not positive.
[[nodiscard]] FrameCost FitFrameCost(std::span<const FrameGroup> groups);

}  // namespace osteon::simulation
