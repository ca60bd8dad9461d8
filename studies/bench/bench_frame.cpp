#include "studies/bench/bench_frame.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/phase_progress.h"
#include "base/write_text.h"
#include "config/reading/load.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"
#include "studies/bench/bench_workloads.h"
#include "studies/bench/timing_rounds.h"

namespace osteon::studies {
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

// Converts a method's name to the engine's name, and back; other methods keep their names.
std::string EngineOfMethod(const std::string& method) { return method == "ours" ? "vulkan" : method; }
std::string MethodOfEngine(const std::string& engine) { return engine == "vulkan" ? "ours" : engine; }

// The instruction set of the CPU engine: "AVX-512" from its description "one thread, AVX-512"; null for other
// methods.
nlohmann::json InstructionSetJson(const FrameTiming& timing) {
  const std::size_t comma = timing.device.rfind(", ");
  if (timing.method != "cpu" || comma == std::string::npos) return nullptr;
  return timing.device.substr(comma + 2);
}

// Lowest and highest ratio among the rounds.
nlohmann::json RangeJson(const RoundRange& range) { return {range.low, range.high}; }

// A named workload of `--workloads`, or the one that the other options describe.
struct WantedWorkload {
  std::string name;
  BenchFrameOptions options;
};

std::vector<WantedWorkload> WantedWorkloads(const BenchFrameOptions& options) {
  if (options.workloads.empty()) return {{.name = options.scene, .options = options}};
  std::vector<WantedWorkload> wanted;
  for (const BenchWorkload& workload : SelectWorkloads(options.workloads)) {
    wanted.push_back({.name = workload.name, .options = options});
    BenchFrameOptions& own = wanted.back().options;
    own.scene = workload.scene;
    own.tool_spheres = workload.tool_spheres;
    if (options.spheres == 0) own.spheres = workload.spheres;
  }
  return wanted;
}

// The methods in the order of their timing: first the engines or the method, then the methods of `--compare`.
std::vector<std::string> MethodsOf(const BenchFrameOptions& options) {
  std::vector<std::string> methods;
  for (const std::string& engine : options.engines) methods.push_back(MethodOfEngine(engine));
  if (methods.empty()) methods.push_back(options.method);
  methods.insert(methods.end(), options.compare.begin(), options.compare.end());
  return methods;
}

// @returns an error if a value of `--compare` is not accepted; otherwise an empty string
std::string CompareError(const BenchFrameOptions& options) {
  const std::vector<std::string> methods = MethodsOf(options);
  for (const std::string& compare : options.compare) {
    if (std::ranges::count(methods, compare) > 1)
      return fmt::format("--compare {}: found the method itself, accepted another", compare);
    if (WantsDisjoint(compare) != WantsDisjoint(methods.front()))
      return fmt::format("--compare {}: works on another packing than {}: time it by itself", compare,
                         methods.front());
  }
  return {};
}

// A workload's figures for each method. The first `engines` methods are engines. Each method is compared with
// the first method and with the last of the engines.
class WorkloadFigures {
 public:
  WorkloadFigures(const RoundWorkload& workload, const WantedWorkload& wanted, const WorkloadRounds& rounds,
                  std::size_t engines)
      : workload_(workload), wanted_(wanted), rounds_(rounds), last_engine_(engines - 1) {}

  // The timing of the first method.
  [[nodiscard]] const FrameTiming& own() const { return rounds_.methods.front().timing; }

  [[nodiscard]] nlohmann::json EnginesJson() const {
    nlohmann::json engines = nlohmann::json::array();
    for (const MethodRounds& method : rounds_.methods) {
      const TimeRatio to_first = RatioOf(method, first()), to_last = RatioOf(method, last());
      nlohmann::json json = TimingJson(method.timing);
      json["engine"] = EngineOfMethod(method.timing.method);
      json["instruction_set"] = InstructionSetJson(method.timing);
      json["ratio"] = to_first.p50;
      json["ratio_p999"] = to_first.p999;
      json["ratio_to_last"] = to_last.p50;
      json["ratio_p999_to_last"] = to_last.p999;
      json["ratio_to_last_range"] = RangeJson(to_last.p50_range);
      json["ratio_p999_to_last_range"] = RangeJson(to_last.p999_range);
      json["rounds"] = nlohmann::json::array();
      for (const simulation::TimeFigures& round : method.rounds) json["rounds"].push_back(TimesJson(round));
      engines.push_back(std::move(json));
    }
    return engines;
  }

  [[nodiscard]] nlohmann::json Json() const {
    return {{"name", workload_.name},
            {"scene", wanted_.options.scene},
            {"spheres", workload_.work.bone.balls.size()},
            {"tool_spheres", workload_.work.cutting_balls},
            {"mass_points", workload_.work.bone.points.size()},
            {"cut_zone_mm", workload_.work.cut_zone_m * 1e3},
            {"left_out", rounds_.left_out},
            {"engines", EnginesJson()}};
  }

  void Print(bool with_passes) const {
    const simulation::FrameWorkload& work = workload_.work;
    const std::string name = workload_.name == wanted_.options.scene ? "" : workload_.name + ": ";
    fmt::print("Osteon bench frame: {}{}, {} spheres, tool of {}, on {}\n", name, wanted_.options.scene,
               work.bone.balls.size(), work.cutting_balls, own().device);
    fmt::print("  cut zone: spheres {:.3f} mm apart down to {:g} mm; mean force {:.1f} N\n\n",
               work.cut_zone_m * 1e3, work.cut_zone_depth_m * 1e3, own().force_N);
    const bool several = rounds_.methods.size() > 1;
    fmt::print("{:<14} {:>7} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}{}\n", "method", "frames", "p50 us",
               "p95", "p99", "p99.9", "max", "rate Hz", "active",
               several ? fmt::format("  p50 and p99.9 over {}'s", NameOf(last())) : "");
    for (const MethodRounds& method : rounds_.methods) {
      const TimeRatio ratio = RatioOf(method, last());
      fmt::print("{}{}\n", Row(NameOf(method), method.timing),
                 several ? fmt::format("  {:.3f} {:.3f}", ratio.p50, ratio.p999) : "");
    }
    for (const std::string& left : rounds_.left_out) fmt::print("left out: {}\n", left);
    if (with_passes)
      for (const auto& [pass, us] : own().pass_us) fmt::print("  {:<24} {:>9.1f} us\n", pass, us);
    if (several) fmt::print("\n");
    for (const MethodRounds& method : std::span(rounds_.methods).subspan(1)) PrintRatio(method);
  }

 private:
  [[nodiscard]] const MethodRounds& first() const { return rounds_.methods.front(); }
  [[nodiscard]] const MethodRounds& last() const {
    return rounds_.methods[std::min(last_engine_, rounds_.methods.size() - 1)];
  }
  [[nodiscard]] std::string NameOf(const MethodRounds& method) const {
    return wanted_.options.engines.empty() ? method.timing.method : EngineOfMethod(method.timing.method);
  }

  // A line of the printed table.
  static std::string Row(const std::string& name, const FrameTiming& timing) {
    const simulation::TimeFigures& us = timing.frame_us;
    return fmt::format("{:<14} {:>7} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.0f} {:>9}", name,
                       timing.frames, us.p50_us, us.p95_us, us.p99_us, us.p999_us, us.max_us,
                       timing.rate_hz(),
                       timing.active_spheres_mean ? fmt::format("{:.0f}", *timing.active_spheres_mean) : "-");
  }

  // Prints the ratio of a method's time to that of the first method.
  void PrintRatio(const MethodRounds& method) const {
    const TimeRatio ratio = RatioOf(method, first());
    const auto range = [&](const RoundRange& of) {
      return method.rounds.size() > 1 ? fmt::format(" [{:.2f} … {:.2f}]", of.low, of.high) : std::string();
    };
    fmt::print("{} on {} takes {:.2f}{} times as long as {} (99.9th percentile {:.2f}{} times)\n",
               NameOf(method), method.timing.device, ratio.p50, range(ratio.p50_range), NameOf(first()),
               ratio.p999, range(ratio.p999_range));
  }

  const RoundWorkload& workload_;
  const WantedWorkload& wanted_;
  const WorkloadRounds& rounds_;
  std::size_t last_engine_;
};

// The number of phases that the progress shows: packing, seating, rounds, and passes of the first round.
int PhaseCount(const std::vector<std::string>& methods, std::size_t workloads, std::size_t rounds) {
  const auto own = std::ranges::count_if(methods, [](const auto& method) { return !SharesState(method); });
  const auto passes = std::ranges::count(methods, "ours") + std::ranges::count(methods, "cpu");
  const bool shared = std::ranges::any_of(methods, SharesState);
  return static_cast<int>(workloads * (1 + (shared ? 1 : 0) + own + rounds + passes));
}

// Runs the subcommand, except that it throws if an option is not accepted.
int Run(const BenchFrameOptions& options) {
  if (const std::string wrong = CompareError(options); !wrong.empty())
    return session::Fail("bench frame", wrong);
  const std::vector<std::string> methods = MethodsOf(options);
  const std::vector<WantedWorkload> wanted = WantedWorkloads(options);
  base::PhaseProgress progress("osteon bench frame", PhaseCount(methods, wanted.size(), options.rounds));
  base::InstallInterrupt();
  const auto begun = std::chrono::steady_clock::now();
  std::vector<RoundWorkload> workloads;
  for (const WantedWorkload& each : wanted) {
    progress.BeginPhase("pack " + each.name);
    workloads.push_back({.name = each.name, .work = MakeBenchWorkload(each.options), .methods = methods});
    if (base::Interrupted()) return base::kExitInterrupted;
  }
  const double pack_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();

  const std::size_t engines = std::max<std::size_t>(1, options.engines.size());
  const RoundsParams params{
      .timing = {.methods = methods,
                 .device = options.device,
                 .frames = options.frames,
                 .max_seconds = options.max_seconds,
                 .voxel_m = 1e-3 * options.voxel_mm,
                 .progress = [&](const std::string& phase) { progress.BeginPhase(phase); }},
      .rounds = options.rounds,
      .required = std::vector(methods.begin(), methods.begin() + static_cast<std::ptrdiff_t>(engines))};
  auto timed = TimeRounds(workloads, params);
  progress.Done();
  if (!timed) return session::Fail("bench frame", timed.error(), session::kFailed);

  nlohmann::json json;
  nlohmann::json all = nlohmann::json::array();
  for (std::size_t w = 0; w < wanted.size(); ++w) {
    WorkloadRounds& rounds = (*timed)[w];
    // Ctrl-C came before the workload's first frame
    std::erase_if(rounds.methods, [](const MethodRounds& method) { return method.rounds.empty(); });
    if (rounds.methods.empty()) continue;
    const WorkloadFigures figures(workloads[w], wanted[w], rounds,
                                  options.engines.empty() ? methods.size() : engines);
    if (!all.empty()) fmt::print("\n");
    figures.Print(wanted.size() == 1);
    all.push_back(figures.Json());
    if (all.size() > 1) continue;
    // the first workload's figures stand at the top as well
    const simulation::FrameWorkload& work = workloads[w].work;
    json = TimingJson(figures.own());
    json["spheres"] = work.bone.balls.size();
    json["tool_spheres"] = work.cutting_balls;
    json["mass_points"] = work.bone.points.size();
    json["scene"] = wanted[w].options.scene;
    json["cut_zone_mm"] = work.cut_zone_m * 1e3;
    json["cut_zone_depth_mm"] = work.cut_zone_depth_m * 1e3;
    json["hand_force_N"] = work.motion ? nlohmann::json() : nlohmann::json(work.hand.force_N);
    if (!options.engines.empty()) json["engines"] = all.front()["engines"];
    if (options.engines.empty() && rounds.methods.size() > 1) json["compare"] = all.front()["engines"][1];
  }
  fmt::print("\npacked in {:.1f} s; {} rounds\n", pack_s, options.rounds);
  json["schema"] = "osteon.bench.frame/1";
  json["subcommand"] = "bench frame";
  json["packing"] = WantsDisjoint(options.method) ? "disjoint" : options.uniform ? "uniform" : "fixed zone";
  json["pack_seconds"] = pack_s;
  json["peak_memory_MB"] = PeakMemory_MB();
  json["machine"] = session::MachineName();
  json["rounds"] = options.rounds;
  json["workloads"] = std::move(all);
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, base::JsonText(json)); !written)
      return session::Fail("bench frame", written.error(), session::kFailed);
  return base::Interrupted() ? base::kExitInterrupted : 0;
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
    return session::Fail("bench frame", error.what());
  }
}

double PeakMemory_MB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace osteon::studies
