#include "studies/bench/bench_frame.h"

#include <sys/resource.h>

#include <chrono>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/phase_progress.h"
#include "base/write_text.h"
#include "config/reading/load.h"
#include "session/process/exit_code.h"

namespace osteon::app {
namespace {

nlohmann::json TimesJson(const simulation::TimeFigures& times) {
  return {{"p50", times.p50_us},
          {"p95", times.p95_us},
          {"p99", times.p99_us},
          {"p999", times.p999_us},
          {"max", times.max_us}};
}

nlohmann::json TimingJson(const FrameTiming& timing) {
  nlohmann::json json{{"method", timing.method},        {"device", timing.device},
                      {"frames", timing.frames},        {"frame_us", TimesJson(timing.frame_us)},
                      {"pass_us", timing.pass_us},      {"rate_hz", timing.rate_hz()},
                      {"mean_force_N", timing.force_N}, {"removed_mm3", timing.removed_mm3},
                      {"active_spheres_mean", nullptr}};
  if (timing.active_spheres_mean) json["active_spheres_mean"] = *timing.active_spheres_mean;
  return json;
}

// The engine's name of a method; other methods keep theirs.
std::string EngineOfMethod(const std::string& method) { return method == "ours" ? "vulkan" : method; }

std::string Row(const std::string& name, const FrameTiming& timing) {
  const simulation::TimeFigures& us = timing.frame_us;
  return fmt::format("{:<14} {:>7} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.0f} {:>9}\n", name,
                     timing.frames, us.p50_us, us.p95_us, us.p99_us, us.p999_us, us.max_us, timing.rate_hz(),
                     timing.active_spheres_mean ? fmt::format("{:.0f}", *timing.active_spheres_mean) : "-");
}

// Prints the times of engines that were timed in turn, relative to the first. @returns them as JSON
nlohmann::json CompareEngines(const std::vector<FrameTiming>& timings) {
  nlohmann::json engines = nlohmann::json::array();
  const FrameTiming& first = timings.front();
  for (const FrameTiming& timing : timings) {
    nlohmann::json json = TimingJson(timing);
    json["engine"] = EngineOfMethod(timing.method);
    json["ratio"] = timing.frame_us.p50_us / first.frame_us.p50_us;
    json["ratio_p999"] = timing.frame_us.p999_us / first.frame_us.p999_us;
    engines.push_back(json);
    if (&timing == &first) continue;
    fmt::print("\n{} on {} takes {:.2f} times as long as {} (99.9th percentile {:.2f} times)\n",
               EngineOfMethod(timing.method), timing.device, json["ratio"].get<double>(),
               EngineOfMethod(first.method), json["ratio_p999"].get<double>());
  }
  return engines;
}

int Run(const BenchFrameOptions& options) {
  if (options.compare == options.method)
    return Fail("bench frame",
                fmt::format("--compare {}: found the method itself, accepted another", options.compare));
  if (!options.compare.empty() && WantsDisjoint(options.compare) != WantsDisjoint(options.method))
    return Fail("bench frame",
                fmt::format("--compare {}: works on another packing than {}: time it by itself",
                            options.compare, options.method));
  PhaseProgress progress("osteon bench frame", 4);
  progress.BeginPhase("pack");
  const auto begun = std::chrono::steady_clock::now();
  const simulation::FrameWorkload work = MakeBenchWorkload(options);
  const double pack_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();

  InstallInterrupt();
  FrameTimingParams params{.methods = {options.method},
                           .device = options.device,
                           .frames = options.frames,
                           .max_seconds = options.max_seconds,
                           .voxel_m = 1e-3 * options.voxel_mm,
                           .progress = [&](const std::string& phase) { progress.BeginPhase(phase); }};
  if (!options.compare.empty()) params.methods.push_back(options.compare);
  if (!options.engines.empty()) params.methods.clear();
  for (const std::string& engine : options.engines)
    params.methods.push_back(engine == "vulkan" ? "ours" : engine);
  const auto timings = TimeFrames(work, params);
  progress.Done();
  if (!timings) return Fail("bench frame", timings.error(), kFailed);

  const FrameTiming& own = timings->front();
  fmt::print("Osteon bench frame: {}, {} spheres, tool of {}, on {}\n", options.scene, work.bone.balls.size(),
             work.cutting_balls, own.device);
  fmt::print(
      "  cut zone: spheres {:.3f} mm apart down to {:g} mm; mean force {:.1f} N; packed in {:.1f} s\n\n",
      work.cut_zone_m * 1e3, work.cut_zone_depth_m * 1e3, own.force_N, pack_s);
  fmt::print("{:<14} {:>7} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "method", "frames", "p50 us", "p95",
             "p99", "p99.9", "max", "rate Hz", "active");
  for (const FrameTiming& timing : *timings)
    fmt::print("{}", Row(options.engines.empty() ? timing.method : EngineOfMethod(timing.method), timing));
  for (const auto& [pass, us] : own.pass_us) fmt::print("  {:<24} {:>9.1f} us\n", pass, us);

  nlohmann::json json = TimingJson(own);
  json["schema"] = "osteon.bench.frame/1";
  json["subcommand"] = "bench frame";
  json["spheres"] = work.bone.balls.size();
  json["tool_spheres"] = work.cutting_balls;
  json["mass_points"] = work.bone.points.size();
  json["scene"] = options.scene;
  json["packing"] = WantsDisjoint(options.method) ? "disjoint" : options.uniform ? "uniform" : "fixed zone";
  json["cut_zone_mm"] = work.cut_zone_m * 1e3;
  json["cut_zone_depth_mm"] = work.cut_zone_depth_m * 1e3;
  json["hand_force_N"] = options.scene == "acetabulum" ? nlohmann::json(work.hand.force_N) : nlohmann::json();
  json["pack_seconds"] = pack_s;
  json["peak_memory_MB"] = PeakMemory_MB();
  if (!options.engines.empty()) {
    json["engines"] = CompareEngines(*timings);
  } else if (timings->size() > 1) {
    const FrameTiming& other = timings->back();
    const double ratio = other.frame_us.p50_us / own.frame_us.p50_us;
    fmt::print("\n{} takes {:.2f} times as long as {}\n", other.method, ratio, own.method);
    json["compare"] = TimingJson(other);
    json["compare"]["ratio"] = ratio;
  }
  if (!options.json.empty())
    if (const auto written = WriteText(options.json, JsonText(json)); !written)
      return Fail("bench frame", written.error(), kFailed);
  return Interrupted() ? kExitInterrupted : 0;
}

}  // namespace

simulation::FrameWorkload MakeBenchWorkload(const BenchFrameOptions& options) {
  simulation::FrameWorkloadParams params = simulation::CupWorkload();
  if (options.scene == "molar") {
    const config::CellConfig cell = config::LoadCell(options.config_root / "cells" / "molar.yaml");
    params.scene = cell.scene;
    params.tool = cell.tool.tool;
    params.cutting = cell.cutting;
    params.shell = simulation::ShellPart::kSphere;
    auto motion = simulation::LoadMotion(options.config_root / "motions" / "molar.csv");
    if (!motion) throw std::invalid_argument(motion.error());
    params.motion = std::move(*motion);
  } else if (options.scene != "acetabulum") {
    throw std::invalid_argument(fmt::format("--scene {}: accepted acetabulum, molar", options.scene));
  }
  params.spheres = options.spheres;
  params.tool_spheres = options.tool_spheres;
  params.disjoint = WantsDisjoint(options.method);
  if (options.uniform) params.grade = simulation::CountedGrade::kUniform;
  return simulation::MakeFrameWorkload(params);
}

int RunBenchFrame(const BenchFrameOptions& options) {
  try {
    return Run(options);
  } catch (const std::invalid_argument& error) {
    return Fail("bench frame", error.what());
  }
}

double PeakMemory_MB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace osteon::app
