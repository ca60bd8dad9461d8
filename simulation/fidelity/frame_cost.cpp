#include "simulation/fidelity/frame_cost.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "base/percentile.h"
#include "simulation/fidelity/frame_workload.h"

namespace osteon::simulation {
namespace {

// A frame counts as interrupted if its threads waited for a processor longer than kMinWait_us and longer than
// kMinWaitShare of the median frame time.
constexpr double kMinWait_us = 20.0, kMinWaitShare = 0.05;

}  // namespace

FrameGroup GroupOf(std::span<const FrameSample> samples) {
  if (samples.empty()) throw std::invalid_argument("frame cost: found no frame, accepted one and more");
  std::vector<double> all, balls, calm;
  for (const FrameSample& sample : samples) {
    all.push_back(sample.us);
    balls.push_back(sample.active_balls);
  }
  FrameGroup group{.frames = samples.size(),
                   .active_balls = FiguresOf(std::move(balls)).p50_us,
                   .p50_us = FiguresOf(all).p50_us};
  const double max_us = std::max(kMinWait_us, kMinWaitShare * group.p50_us);
  for (const FrameSample& sample : samples)
    if (sample.waited_us <= max_us) calm.push_back(sample.us);
  group.interrupted = samples.size() - calm.size();
  group.p999_us = FiguresOf(calm.empty() ? std::move(all) : std::move(calm)).p999_us;
  return group;
}

FrameCost FitFrameCost(std::span<const FrameGroup> groups) {
  if (groups.size() < 2)
    throw std::invalid_argument(
        fmt::format("frame cost: found {} groups of frames, accepted two and more", groups.size()));
  // Minimise the sum of ((t0 + c N)/t - 1)² over the groups, t being a group's median. These are the sums of
  // the normal equations, with a = 1/t and b = N/t.
  double aa = 0.0, ab = 0.0, bb = 0.0, a1 = 0.0, b1 = 0.0;
  std::vector<double> tails;
  for (const FrameGroup& group : groups) {
    if (!(group.p50_us > 0.0))
      throw std::invalid_argument(
          fmt::format("frame cost: median: found {:g} us, accepted more than 0", group.p50_us));
    const double a = 1.0 / group.p50_us, b = group.active_balls / group.p50_us;
    aa += a * a;
    ab += a * b;
    bb += b * b;
    a1 += a;
    b1 += b;
    tails.push_back(group.p999_us / group.p50_us);
  }
  FrameCost cost;
  const double det = aa * bb - ab * ab;
  if (det > 1e-12 * aa * bb) {  // otherwise all groups have the same N
    cost.base_us = (a1 * bb - b1 * ab) / det;
    cost.ball_us = (aa * b1 - ab * a1) / det;
  }
  // if a coefficient is not positive, set it to 0 and fit the other one alone
  if (cost.ball_us <= 0.0) cost = {.base_us = a1 / aa, .ball_us = 0.0};
  if (cost.base_us < 0.0) cost = {.base_us = 0.0, .ball_us = b1 / bb};
  cost.tail_ratio = std::max(1.0, base::Median(tails));
  return cost;
}

}  // namespace osteon::simulation
