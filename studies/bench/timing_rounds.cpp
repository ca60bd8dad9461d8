#include "studies/bench/timing_rounds.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "base/interrupt.h"

namespace osteon::studies {
namespace {

// The starting states of all rounds of a workload.
struct Starts {
  std::vector<std::string> methods;  // the methods that can be timed
  std::optional<SeatedStart> shared;
  OwnStarts own;
};

// Seats the workload's methods. A method that fails is left out with its reason, unless it is required.
tl::expected<Starts, std::string> MakeStarts(const RoundWorkload& workload, const RoundsParams& params,
                                             std::vector<std::string>& left_out) {
  const auto say = [&](const std::string& method) {
    if (params.timing.progress) params.timing.progress(fmt::format("seat {} {}", workload.name, method));
  };
  FrameTimingParams timing = params.timing;
  timing.methods = workload.methods;
  Starts starts;
  for (const std::string& method : workload.methods) {
    std::string error;
    if (SharesState(method)) {
      if (!starts.shared) {
        say("");
        auto seated = Seat(workload.work, timing);
        if (!seated) return tl::unexpected(seated.error());
        starts.shared = std::move(*seated);
      }
    } else {
      say(method);
      auto seated = SeatMethod(workload.work, timing, method);
      if (seated)
        starts.own.emplace(method, std::move(*seated));
      else
        error = seated.error();
    }
    if (error.empty())
      starts.methods.push_back(method);
    else if (base::Interrupted() || std::ranges::count(params.required, method) > 0)
      return tl::unexpected(error);
    else
      left_out.push_back(error);
  }
  return starts;
}

RoundRange RangeOf(const std::vector<double>& values) {
  if (values.empty()) return {};
  const auto [low, high] = std::ranges::minmax(values);
  return {.low = low, .high = high};
}

}  // namespace

tl::expected<std::vector<WorkloadRounds>, std::string> TimeRounds(std::span<const RoundWorkload> workloads,
                                                                  const RoundsParams& params) {
  std::vector<WorkloadRounds> results(workloads.size());
  std::vector<Starts> starts;
  for (std::size_t w = 0; w < workloads.size(); ++w) {
    auto made = MakeStarts(workloads[w], params, results[w].left_out);
    if (!made) return tl::unexpected(made.error());
    starts.push_back(std::move(*made));
    results[w].methods.resize(starts.back().methods.size());
  }
  for (std::size_t round = 0; round < params.rounds; ++round)
    for (std::size_t w = 0; w < workloads.size() && !base::Interrupted(); ++w) {
      FrameTimingParams timing = params.timing;
      timing.methods = starts[w].methods;
      if (round > 0) timing.pass_frames = 0;
      timing.progress = [&](const std::string& phase) {
        if (params.timing.progress)
          params.timing.progress(
              fmt::format("{} {}, round {} of {}", phase, workloads[w].name, round + 1, params.rounds));
      };
      auto timed = TimeFrames(workloads[w].work, timing, starts[w].shared ? &*starts[w].shared : nullptr,
                              starts[w].own);
      if (!timed) return tl::unexpected(timed.error());
      for (std::size_t m = 0; m < timed->size(); ++m) AddRound(results[w].methods[m], std::move((*timed)[m]));
    }
  return results;
}

void AddRound(MethodRounds& rounds, FrameTiming&& timing) {
  if (timing.times_us.empty()) return;
  rounds.rounds.push_back(timing.frame_us);
  if (rounds.rounds.size() == 1) {
    rounds.timing = std::move(timing);
    return;
  }
  FrameTiming& all = rounds.timing;
  const auto before = static_cast<double>(all.frames), added = static_cast<double>(timing.frames);
  // mean of two means, weighted by their numbers of frames
  const auto mean = [&](double a, double b) { return (before * a + added * b) / (before + added); };
  all.times_us.insert(all.times_us.end(), timing.times_us.begin(), timing.times_us.end());
  all.frames = all.times_us.size();
  all.frame_us = simulation::FiguresOf(all.times_us);
  all.mean_us = mean(all.mean_us, timing.mean_us);
  all.force_N = mean(all.force_N, timing.force_N);
  if (all.active_spheres_mean && timing.active_spheres_mean)
    all.active_spheres_mean = mean(*all.active_spheres_mean, *timing.active_spheres_mean);
}

TimeRatio RatioOf(const MethodRounds& method, const MethodRounds& base) {
  const simulation::TimeFigures &own = method.timing.frame_us, &other = base.timing.frame_us;
  std::vector<double> p50, p999;
  for (std::size_t i = 0; i < std::min(method.rounds.size(), base.rounds.size()); ++i) {
    p50.push_back(method.rounds[i].p50_us / base.rounds[i].p50_us);
    p999.push_back(method.rounds[i].p999_us / base.rounds[i].p999_us);
  }
  return {.p50 = own.p50_us / other.p50_us,
          .p999 = own.p999_us / other.p999_us,
          .p50_range = RangeOf(p50),
          .p999_range = RangeOf(p999)};
}

}  // namespace osteon::studies
