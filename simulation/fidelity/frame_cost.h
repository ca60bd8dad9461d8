#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace osteon::simulation {

/// One timed frame.
struct FrameSample {
  double us{0.0};
  double active_balls{0.0};  ///< that the engine worked on
  bool interrupted{false};   ///< the machine took the processor away meanwhile
};

/// Frames of one packing.
struct FrameGroup {
  std::size_t frames{0}, interrupted{0};
  double active_balls{0.0};          ///< median of all frames
  double p50_us{0.0}, p999_us{0.0};  ///< of those that were not interrupted
};

/// Short frames are interrupted less often than long ones: so the median is taken in nine parts of all
/// frames, by their active balls, of each part's calm frames (three at least, or the part is left out), and
/// then of the parts. Where most parts have not so many, interrupted frames count as well. p99.9: by nearest
/// rank.
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
