// Times cutting frames on one Vulkan device: a reamer pressed into the generated acetabulum with 100 N, or
// the recorded motion of any scene. It links little more than the Vulkan loader and the readers of config/,
// so that the executable can be copied to a machine with a GPU; `osteon bench frame` times the same workload.
//
//     osteon_frame_bench [FRAMES] [--device NAME] [--spheres N] [--uniform] [--tool-spheres M] [--brute]
//                        [--scene CELL.yaml --motion FILE.csv] [--rate HZ]
//                        [--arithmetic int64|words|floats|floats_int64]
//
// Prints a CSV header and one row. Times are wall time around CuttingEngine::Step; the device's own time by
// pass comes from a second run (timestamps slow software drivers down).

#include <charconv>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "config/reading/load.h"
#include "gpu/engine/vulkan_engine.h"
#include "simulation/fidelity/frame_workload.h"

namespace {

using namespace osteon;

struct Options {
  int frames{2000};
  std::string device, scene, motion;
  double rate_hz{1000.0};
  std::size_t spheres{0}, tool_spheres{1};
  bool uniform{false}, brute{false};
  gpu::Arithmetic arithmetic{gpu::Arithmetic::kAuto};
};

const std::map<std::string, gpu::Arithmetic> kArithmetics{{"int64", gpu::Arithmetic::kInt64},
                                                          {"words", gpu::Arithmetic::kWords},
                                                          {"floats", gpu::Arithmetic::kFloats},
                                                          {"floats_int64", gpu::Arithmetic::kFloatsInt64}};

// Reads a number. Returns false if the text contains anything else, or if the number is out of bounds.
template <typename T>
bool Read(const std::string& text, T& value, T min_value, T max_value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && value >= min_value && value <= max_value;
}

// @returns an empty string, or what is wrong with the arguments
std::string ReadOptions(const std::vector<std::string>& words, Options& options) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "--uniform" || word == "--brute") {
      (word == "--brute" ? options.brute : options.uniform) = true;
      continue;
    }
    const bool option = word.starts_with("--");
    if (option && i + 1 == words.size()) return word + ": found nothing after it";
    const std::string& value = option ? words[++i] : word;
    bool good = true;
    if (word == "--scene")
      options.scene = value;
    else if (word == "--motion")
      options.motion = value;
    else if (word == "--device")
      options.device = value;
    else if (word == "--arithmetic") {
      good = kArithmetics.contains(value);
      if (good) options.arithmetic = kArithmetics.at(value);
    } else if (word == "--rate")
      good = Read(value, options.rate_hz, 10.0, 1e4);
    else if (word == "--spheres")
      good = Read(value, options.spheres, std::size_t{100}, std::size_t{20'000'000});
    else if (word == "--tool-spheres")
      good = Read(value, options.tool_spheres, std::size_t{1}, std::size_t{10'000});
    else if (option)
      return "unknown option " + word;
    else
      good = Read(value, options.frames, 2, 10'000'000);
    if (!good) return word + ": found " + value + ", which is unknown or out of range";
  }
  if (options.scene.empty() != options.motion.empty()) return "--scene and --motion belong together";
  return "";
}

simulation::FrameWorkload MakeWorkload(const Options& options) {
  simulation::FrameWorkloadParams params = simulation::CupWorkload();
  if (!options.scene.empty()) {
    const config::CellConfig cell = config::LoadCell(options.scene);
    params.scene = cell.scene;
    params.tool = cell.tool.tool;
    params.cutting = cell.cutting;
    params.shell = simulation::ShellPart::kSphere;
    auto motion = simulation::LoadMotion(options.motion);
    if (!motion) throw std::runtime_error(motion.error());
    params.motion = std::move(*motion);
  }
  params.rate_hz = options.rate_hz;
  params.spheres = options.spheres;
  params.tool_spheres = options.tool_spheres;
  if (options.uniform) params.grade = simulation::CountedGrade::kUniform;
  return simulation::MakeFrameWorkload(params);
}

int Run(const Options& options) {
  const simulation::FrameWorkload work = MakeWorkload(options);
  const auto make = [&](bool time_passes, bool brute) {
    gpu::VulkanParams vulkan;
    vulkan.device = options.device;
    vulkan.time_passes = time_passes;
    vulkan.brute_force = brute;
    vulkan.overrides.arithmetic = options.arithmetic;
    auto engine = gpu::VulkanEngine::Create(work.bone, work.tool, Pose::Identity(), work.cutting, vulkan);
    if (!engine) throw std::runtime_error(engine.error());
    return std::move(*engine);
  };

  // run once until the timing may start; every timed run begins in the state that is reached here
  simulation::ContactModel ready;
  simulation::WorkloadPlayer start(work);
  simulation::CarvedState state;
  {
    const auto engine = make(false, false);
    if (!simulation::RunUntilReady(*engine, start, ready))
      throw std::runtime_error("the tool does not reach the bone");
    state = engine->Snapshot();
  }
  std::vector<double> frame_us;
  std::map<std::string, std::vector<double>> pass_us;
  std::string name;
  simulation::ContactModel last;
  for (const bool time_passes : {false, true}) {
    const auto engine = make(time_passes, options.brute);
    engine->Restore(state);
    name = engine->device();
    simulation::WorkloadPlayer player = start;
    last = ready;
    for (int k = 0; k < options.frames && !player.AtEnd(); ++k) {
      const double us = simulation::TimedStep(*engine, player.Next(last), last);
      if (last.status != simulation::EngineStatus::kOk) throw std::runtime_error("a frame was refused");
      if (!time_passes) frame_us.push_back(us);
      for (const gpu::PassTime& pass : engine->LastPassTimes())
        pass_us[pass.pass].push_back(pass.seconds * 1e6);
    }
  }
  std::string method = options.brute ? "brute" : "ours";
  for (const auto& [value, arithmetic] : kArithmetics)
    if (arithmetic == options.arithmetic) method += "_" + value;
  const simulation::TimeFigures figures = simulation::FiguresOf(frame_us);
  std::printf(
      "device,scene,method,spheres,tool_spheres,cut_zone_mm,mass_points,frames,frame_us_p50,frame_us_p95,"
      "frame_us_p99,frame_us_p999,frame_us_max,removed_mm3");
  for (const auto& [pass, times] : pass_us) std::printf(",%s_us_p50", pass.c_str());
  std::printf("\n\"%s\",\"%s\",%s,%zu,%zu,%.3f,%zu,%zu,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f", name.c_str(),
              work.bone.name.c_str(), method.c_str(), work.bone.balls.size(), work.cutting_balls,
              work.cut_zone_m * 1e3, work.bone.points.size(), frame_us.size(), figures.p50_us, figures.p95_us,
              figures.p99_us, figures.p999_us, figures.max_us, last.removed_volume_m3 * 1e9);
  for (const auto& [pass, times] : pass_us) std::printf(",%.1f", simulation::FiguresOf(times).p50_us);
  std::printf("\n");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (const std::string wrong = ReadOptions({argv + 1, argv + argc}, options); !wrong.empty()) {
    std::fprintf(
        stderr,
        "osteon_frame_bench: %s\nusage: osteon_frame_bench [FRAMES, at least 2] [--device NAME] "
        "[--spheres "
        "N, 100 … 20000000] [--uniform]\n           [--tool-spheres M, 1 … 10000] [--brute] [--scene "
        "CELL.yaml --motion FILE.csv] [--rate HZ, 10 … 10000] [--arithmetic "
        "int64|words|floats|floats_int64]\n",
        wrong.c_str());
    return 2;
  }
  try {
    return Run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "osteon_frame_bench: %s\n", error.what());
    return 1;
  }
}
