#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace osteon::simulation {

/// Timing of one frame.
struct FrameSample {
  double us{0.0};
  double active_balls{0.0};  ///< number of balls that the engine worked on
  double waited_us{0.0};     ///< wait for a processor, summed over all threads
};

/// Timing of the frames of one packing.
struct FrameGroup {
  std::size_t frames{0};
  std::size_t interrupted{0};  ///< frames that waited for more than 20 us and 5 % of the median frame
  double active_balls{0.0};    ///< median
  double p50_us{0.0};          ///< median of all frames
  double p999_us{0.0};  ///< 99.9th percentile of uninterrupted frames; of all frames if all were interrupted
};

/// Computes median and 99.9th percentile (by nearest rank) of frames. The median is over all frames, also
/// interrupted ones: if a GPU driver computes on the processor, its threads wait for each other in most
/// frames, and the few frames without a wait are atypical. (On two cores the median of these few frames was
/// up to five times that of all frames.)
/// @throws std::invalid_argument if there is no frame.
[[nodiscard]] FrameGroup GroupOf(std::span<const FrameSample> samples);

/// Model of the time t of a frame, for one machine and one tool:
///
///     t = t0 + c N      N: number of active balls; t0 = base_us >= 0; c = ball_us >= 0
struct FrameCost {
  double base_us{0.0}, ball_us{0.0};
  double tail_ratio{1.0};  ///< 99.9th percentile divided by the median
  [[nodiscard]] double At(double active_balls) const { return base_us + ball_us * active_balls; }
};

/// Fits t0 and c to the groups' medians by least squares of relative errors. tail_ratio is the median of the
/// groups' ratios of 99.9th percentile to median.
/// @throws std::invalid_argument if there are fewer than two groups, or a median is not positive.
[[nodiscard]] FrameCost FitFrameCost(std::span<const FrameGroup> groups);

}  // namespace osteon::simulation
