#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace osteon::simulation {

/// Timing of one frame.
struct FrameSample {
  double us{0.0};
  double active_balls{0.0};  ///< balls that the engine worked on
  double waited_us{0.0};     ///< wait for a processor, summed over all threads
};

/// Timing of the frames of one packing.
struct FrameGroup {
  std::size_t frames{0};
  std::size_t interrupted{0};  ///< frames that waited for more than 20 us and 5 % of the median frame
  double active_balls{0.0};    ///< median
  double p50_us{0.0};          ///< median of all frames
  double p999_us{0.0};         ///< 99.9th percentile of uninterrupted frames; of all if all were interrupted
};

/// Computes median and 99.9th percentile (by nearest rank) of frames. The median is over all frames: the
/// threads of a driver that computes on the processor wait for each other, so frames without a wait are few
/// and atypical (on two cores their median was up to five times that of all).
/// @throws std::invalid_argument where there is no frame.
[[nodiscard]] FrameGroup GroupOf(std::span<const FrameSample> samples);

/// Time of a frame on a machine, with one tool:
///
///     t = t0 + c N,   N active balls;   t0, c >= 0
struct FrameCost {
  double base_us{0.0}, ball_us{0.0};
  double tail_ratio{1.0};  ///< 99.9th percentile over median
  [[nodiscard]] double At(double active_balls) const { return base_us + ball_us * active_balls; }
};

/// Fits the groups' medians by least squares of relative errors; tail_ratio is the median of the groups'
/// ratios.
/// @throws std::invalid_argument where there are fewer than two groups, or a median is not positive.
[[nodiscard]] FrameCost FitFrameCost(std::span<const FrameGroup> groups);

}  // namespace osteon::simulation
