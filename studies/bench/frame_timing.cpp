#include "studies/bench/frame_timing.h"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/realtime_thread.h"
#include "gpu/engine/vulkan_engine.h"
#include "session/setup/engine_choice.h"
#include "simulation/engine_cpu/cpu_engine.h"

namespace osteon::studies {
namespace {

using simulation::ContactModel;
using simulation::CuttingEngine;
using simulation::FrameWorkload;
using simulation::WorkloadPlayer;

// Smallest number of timed frames, even if they take longer than the time limit.
constexpr std::size_t kMinFrames = 20;

// Number of first frames that are not timed, since a restored engine makes its neighbour lists anew in the
// first frame. The warm-up ends early after kMaxWarmUp_s.
constexpr std::size_t kWarmUpFrames = 20;
constexpr double kMaxWarmUp_s = 0.5;

// A method under measurement, with the sums of its frames so far.
struct Runner {
  std::unique_ptr<CuttingEngine> engine;
  WorkloadPlayer player;
  ContactModel last;
  std::vector<double> times_us;
  double active_sum{0.0}, force_sum_N{0.0}, removed_before_m3{0.0};
  std::size_t active_count{0};
};

// Number of spheres that the last frame worked on; nothing if the method does not report it.
std::optional<double> ActiveOf(const std::string& method, const CuttingEngine& engine, std::size_t spheres) {
  if (method == "brute") return static_cast<double>(spheres);
  if (!SharesState(method)) return std::nullopt;
  return session::ActiveBalls(engine, spheres);
}

// Makes a method's engine for the workload, with its uncut bone.
tl::expected<std::unique_ptr<CuttingEngine>, std::string> EngineFor(const FrameWorkload& work,
                                                                    const FrameTimingParams& params,
                                                                    const std::string& method,
                                                                    bool time_passes = false) {
  return MakeMethodEngine(
      work.bone, work.solid.get(), work.tool, work.cutting,
      {.method = method, .device = params.device, .voxel_m = params.voxel_m, .time_passes = time_passes});
}

// Runs a method from its first pose to the start of the timing.
tl::expected<void, std::string> PrepareRunner(Runner& runner, const std::string& method, double max_seconds) {
  const auto begun = std::chrono::steady_clock::now();
  bool late = false;
  const auto stop = [&] {
    late = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count() > max_seconds;
    return late || base::Interrupted();
  };
  if (simulation::RunUntilReady(*runner.engine, runner.player, runner.last, stop)) return {};
  if (base::Interrupted()) return tl::unexpected(method + ": ended by Ctrl-C before the tool was seated");
  if (late)
    return tl::unexpected(fmt::format("{}: the tool was not seated within {:g} s", method, max_seconds));
  return tl::unexpected(
      fmt::format("{}: the tool did not get to where timing begins within its frames (status {})", method,
                  static_cast<int>(runner.last.status)));
}

// A runner with a new engine, at the workload's first pose.
tl::expected<Runner, std::string> StartedRunner(const FrameWorkload& work, const FrameTimingParams& params,
                                                const std::string& method) {
  auto engine = EngineFor(work, params, method);
  if (!engine) return tl::unexpected(engine.error());
  return Runner{.engine = std::move(*engine), .player = WorkloadPlayer(work), .last = {}, .times_us = {}};
}

// Runs the frames that are not timed.
void WarmUp(Runner& runner) {
  const auto begun = std::chrono::steady_clock::now();
  for (std::size_t k = 0; k < kWarmUpFrames && !runner.player.AtEnd() && !base::Interrupted(); ++k) {
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begun;
    if (taken.count() > kMaxWarmUp_s) return;
    runner.last = runner.engine->Step(runner.player.Next(runner.last));
  }
}

// Adds the last frame's time by pass or stage.
void AddPassTimes(const CuttingEngine& engine, std::map<std::string, std::vector<double>>& times) {
  if (const auto* vulkan = dynamic_cast<const gpu::VulkanEngine*>(&engine))
    for (const gpu::PassTime& pass : vulkan->LastPassTimes()) times[pass.pass].push_back(pass.seconds * 1e6);
  if (const auto* cpu = dynamic_cast<const simulation::CpuEngine*>(&engine)) {
    const auto& stage_s = cpu->LastFrameStats().stage_s;
    for (std::size_t i = 0; i < stage_s.size(); ++i)
      times[simulation::NameOf(static_cast<simulation::CpuStage>(i))].push_back(stage_s[i] * 1e6);
  }
}

// Measures the median time of each pass or stage [us] in a second run from the start.
tl::expected<std::map<std::string, double>, std::string> TimePasses(const FrameWorkload& work,
                                                                    const FrameTimingParams& params,
                                                                    const std::string& method,
                                                                    const SeatedStart& start) {
  auto made = EngineFor(work, params, method, true);
  if (!made) return tl::unexpected(made.error());
  CuttingEngine& engine = **made;
  engine.Restore(start.state);
  WorkloadPlayer player = start.player;
  ContactModel last = start.last;
  std::map<std::string, std::vector<double>> times;
  for (std::size_t k = 0; k < params.pass_frames && !player.AtEnd() && !base::Interrupted(); ++k) {
    last = engine.Step(player.Next(last));
    AddPassTimes(engine, times);
  }
  std::map<std::string, double> medians;
  for (auto& [pass, us] : times) medians[pass] = simulation::FiguresOf(std::move(us)).p50_us;
  return medians;
}

// The figures of a runner whose frames are timed.
FrameTiming Finish(const Runner& runner, const std::string& method, const FrameWorkload& work) {
  FrameTiming timing{.method = method, .device = runner.engine->device(), .times_us = runner.times_us};
  timing.elements = ElementsOf(*runner.engine, work.bone);
  timing.frames = runner.times_us.size();
  timing.frame_us = simulation::FiguresOf(runner.times_us);
  if (timing.frames > 0) {
    const auto frames = static_cast<double>(timing.frames);
    timing.mean_us = std::accumulate(runner.times_us.begin(), runner.times_us.end(), 0.0) / frames;
    timing.force_N = runner.force_sum_N / frames;
  }
  if (runner.active_count > 0)
    timing.active_spheres_mean = runner.active_sum / static_cast<double>(runner.active_count);
  timing.removed_mm3 = (runner.last.removed_volume_m3 - runner.removed_before_m3) * 1e9;
  return timing;
}

}  // namespace

tl::expected<SeatedStart, std::string> Seat(const FrameWorkload& work, const FrameTimingParams& params) {
  return SeatMethod(work, params, std::ranges::count(params.methods, "cpu") > 0 ? "cpu" : "ours");
}

tl::expected<SeatedStart, std::string> SeatMethod(const FrameWorkload& work, const FrameTimingParams& params,
                                                  const std::string& method) {
  auto runner = StartedRunner(work, params, method);
  if (!runner) return tl::unexpected(runner.error());
  if (const auto prepared = PrepareRunner(*runner, method, params.max_seat_seconds); !prepared)
    return tl::unexpected(prepared.error());
  return SeatedStart{.state = runner->engine->Snapshot(), .player = runner->player, .last = runner->last};
}

tl::expected<std::vector<FrameTiming>, std::string> TimeFrames(const FrameWorkload& work,
                                                               const FrameTimingParams& params,
                                                               const SeatedStart* start,
                                                               const OwnStarts& own) {
  rt::KeepCpusAwake();
  const auto say = [&](const std::string& text) {
    if (params.progress) params.progress(text);
  };
  // bring all methods to the start of the timing
  std::optional<SeatedStart> made;
  if (start == nullptr && std::ranges::any_of(params.methods, SharesState)) {
    say("seat");
    auto seated = Seat(work, params);
    if (!seated) return tl::unexpected(seated.error());
    start = &made.emplace(std::move(*seated));
  }
  std::vector<Runner> runners;
  for (const std::string& method : params.methods) {
    auto runner = StartedRunner(work, params, method);
    if (!runner) return tl::unexpected(runner.error());
    const auto own_start = own.find(method);
    const SeatedStart* from = SharesState(method)      ? start
                              : own_start != own.end() ? &own_start->second
                                                       : nullptr;
    if (from != nullptr) {
      runner->engine->Restore(from->state);
      runner->player = from->player;
      runner->last = from->last;
    } else {
      say("seat " + method);
      if (const auto prepared = PrepareRunner(*runner, method, params.max_seat_seconds); !prepared)
        return tl::unexpected(prepared.error());
    }
    WarmUp(*runner);
    runner->removed_before_m3 = runner->last.removed_volume_m3;
    runners.push_back(std::move(*runner));
  }

  // Time frame by frame in turn; another method begins each time, so that none always comes first.
  say("time");
  const auto begun = std::chrono::steady_clock::now();
  for (std::size_t k = 0; k < params.frames && !base::Interrupted(); ++k) {
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begun;
    if (k >= kMinFrames && taken.count() > params.max_seconds) break;
    if (std::ranges::all_of(runners, [](const Runner& runner) { return runner.player.AtEnd(); })) break;
    for (std::size_t i = 0; i < runners.size(); ++i) {
      const std::size_t which = (i + k) % runners.size();
      Runner& runner = runners[which];
      if (runner.player.AtEnd()) continue;
      const simulation::FrameInput input = runner.player.Next(runner.last);
      runner.times_us.push_back(simulation::TimedStep(*runner.engine, input, runner.last));
      if (runner.last.status != simulation::EngineStatus::kOk)
        return tl::unexpected(params.methods[which] + ": a frame was refused, or the device is lost");
      runner.force_sum_N += Vector3(runner.last.F_T_W.f).norm();
      if (const auto active = ActiveOf(params.methods[which], *runner.engine, work.bone.balls.size())) {
        runner.active_sum += *active;
        ++runner.active_count;
      }
    }
  }
  std::vector<FrameTiming> timings;
  for (std::size_t i = 0; i < runners.size(); ++i)
    timings.push_back(Finish(runners[i], params.methods[i], work));

  for (std::size_t i = 0; i < runners.size() && params.pass_frames > 0; ++i) {
    if (params.methods[i] != "ours" && params.methods[i] != "cpu") continue;
    say("time by pass");
    auto passes = TimePasses(work, params, params.methods[i], *start);
    if (!passes) return tl::unexpected(passes.error());
    timings[i].pass_us = std::move(*passes);
  }
  return timings;
}

}  // namespace osteon::studies
