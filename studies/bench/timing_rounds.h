#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "studies/bench/frame_timing.h"

namespace osteon::studies {

/// A workload with the methods to time on it.
struct RoundWorkload {
  std::string name;
  simulation::FrameWorkload work;
  std::vector<std::string> methods;
};

/// A method's frames of all rounds together, and the figures of each round.
struct MethodRounds {
  FrameTiming timing;  ///< percentiles over the frames of all rounds; time by pass of the first round
  std::vector<simulation::TimeFigures> rounds{};
};

/// Times of one workload over all rounds.
struct WorkloadRounds {
  std::vector<MethodRounds> methods;
  std::vector<std::string> left_out;  ///< methods that were not timed, and why
};

/// Parameters of TimeRounds.
struct RoundsParams {
  FrameTimingParams
      timing;  ///< parameters of one round of one workload; its methods are replaced by the workload's
  std::size_t rounds{1};
  /// Methods whose failure to begin fails the whole run; others are left out.
  std::vector<std::string> required{};
};

/// Times each workload's methods in rounds: a round goes through all workloads, and through a workload's
/// methods frame by frame in turn (TimeFrames), so that a slow minute of the machine affects all methods
/// equally, and only some rounds. Every round begins from the same carved state, with new engines. On Ctrl-C
/// the timing ends early, with the frames so far.
/// @returns one result per workload, or an error if a required method can't run here
[[nodiscard]] tl::expected<std::vector<WorkloadRounds>, std::string> TimeRounds(
    std::span<const RoundWorkload> workloads, const RoundsParams& params);

/// Adds one round's timing of a method to the rounds before it.
void AddRound(MethodRounds& rounds, FrameTiming&& timing);

/// Smallest and largest value of a figure among the rounds.
struct RoundRange {
  double low{0.0}, high{0.0};
};

/// Time of `method` over the time of `base`, for all rounds together and from round to round.
struct TimeRatio {
  double p50{0.0}, p999{0.0};  ///< ratio of medians, and of 99.9th percentiles
  RoundRange p50_range{}, p999_range{};
};
[[nodiscard]] TimeRatio RatioOf(const MethodRounds& method, const MethodRounds& base);

}  // namespace osteon::studies
