// Times cutting frames on one Vulkan device: a reamer pressed into the generated acetabulum, or the recorded
// motion of any scene played again. Links the Vulkan loader and the readers of config/, little more, so that
// the executable travels to a machine with a GPU.
//
//     osteon_frame_bench [FRAMES] [FINENESS] [DEVICE] [--scene CELL.yaml --motion FILE.csv] [--rate HZ]
//                        [--spheres N]
//
// FINENESS divides the packing's and the points' finest lengths; with --spheres the packing has so many
// balls. Prints a CSV header and one row; times are wall time around CuttingEngine::Step, and the device's
// own by pass in a second run (timestamps slow software drivers down).

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "config/load.h"
#include "gpu/vulkan_engine.h"
#include "simulation/motion_player.h"
#include "simulation/scenes.h"

namespace {

using namespace osteon;

struct Options {
  int frames{2000};
  double fineness{1.0};
  std::string device, scene, motion;
  double rate_hz{1000.0};
  std::size_t spheres{0};
};

// What is worked on, and how.
struct Work {
  simulation::Bone bone;
  simulation::Tool tool;
  simulation::CuttingParams cutting;
  std::optional<simulation::MotionPlayer> player;  // nothing: pressed
};

template <typename T>
bool Read(const std::string& text, T& value, T least, T most) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && value >= least && value <= most;
}

// An empty string, or what is wrong.
std::string ReadOptions(const std::vector<std::string>& words, Options& options) {
  int place = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
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
    else if (word == "--rate")
      good = Read(value, options.rate_hz, 10.0, 1e4);
    else if (word == "--spheres")
      good = Read(value, options.spheres, std::size_t{100}, std::size_t{10'000'000});
    else if (option)
      return "unknown option " + word;
    else if (place == 0)
      good = Read(value, options.frames, 2, 10'000'000);
    else if (place == 1)
      good = Read(value, options.fineness, 0.1, 10.0);
    else
      options.device = value;
    if (!option) ++place;
    if (!good) return word + ": found " + value + ", which is no number or out of range";
  }
  if (options.scene.empty() != options.motion.empty()) return "--scene and --motion belong together";
  return "";
}

void Refine(double fineness, simulation::PackingParams& packing, simulation::MassPointParams& points) {
  packing.lattice.finest_m /= fineness;
  packing.cup_radius_cap_m /= fineness;
  packing.least_radius_m /= fineness;
  packing.surface_gap_m /= fineness;
  packing.samples.finest_m /= fineness;
  points.cells.finest_m /= fineness;
}

Work MakeWork(const Options& options) {
  Work work;
  if (options.scene.empty()) {
    simulation::AcetabulumParams params;
    Refine(options.fineness, params.packing, params.points);
    params.packing.count = options.spheres;
    work.bone = simulation::MakeAcetabulum(params);
    work.tool = simulation::MakeReamer(0.025, 0.008, 0.12, 0.9, Vector3(0, 0, -0.025));
    return work;
  }
  config::CellConfig cell = config::LoadCell(options.scene);
  Refine(options.fineness, cell.scene.packing, cell.scene.points);
  cell.scene.packing.count = options.spheres;
  work.bone = simulation::PackScene(simulation::MakeSceneSolid(cell.scene), cell.scene);
  work.tool = cell.tool.tool;
  work.cutting = cell.cutting;
  const auto motion = simulation::LoadMotion(options.motion);
  if (!motion) throw std::runtime_error(motion.error());
  work.player.emplace(*motion, options.rate_hz);
  return work;
}

double At(std::vector<double>& sorted, double share) {
  return sorted[std::min(sorted.size() - 1,
                         static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
}

// One frame, and how long it took [us].
double Timed(gpu::VulkanEngine& engine, const simulation::FrameInput& input,
             simulation::ContactModel& model) {
  const auto start = std::chrono::steady_clock::now();
  model = engine.Step(input);
  const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
  return took.count();
}

// Reams for `frames` milliseconds under up to 120 N; calls `done` after each frame of the second half.
template <class Done>
simulation::ContactModel Ream(gpu::VulkanEngine& engine, int frames, Done done) {
  constexpr double kStep_s = 1e-3, kMass_kg = 3.0, kDrag_Ns_per_m = 300.0, kHead_m = 0.025, kMost_N = 120.0;
  simulation::ContactModel model;
  double height_m = 0.008, speed_m_per_s = 0.0;
  for (int k = 0; k < frames; ++k) {
    const double push_N = std::min(kMost_N, 0.4 * k);
    speed_m_per_s = (speed_m_per_s + kStep_s / kMass_kg * (Vector3(model.F_T_W.f).z() - push_N)) /
                    (1.0 + kStep_s * kDrag_Ns_per_m / kMass_kg);
    height_m += speed_m_per_s * kStep_s;
    Pose X_WT = Pose::Identity();
    X_WT.linear() = Eigen::DiagonalMatrix<double, 3>(1, -1, -1);
    X_WT.translation() = Vector3(0, 0, height_m - kHead_m);
    const double took_us = Timed(engine,
                                 {.X_WT = X_WT,
                                  .spindle_rad_per_s = 250.0 * 2.0 * std::numbers::pi / 60.0,
                                  .dt_s = kStep_s,
                                  .stamp = k},
                                 model);
    if (k >= frames / 2) done(took_us);
  }
  return model;
}

// Plays a motion, all of it; calls `done` after each frame.
template <class Done>
simulation::ContactModel Play(gpu::VulkanEngine& engine, const simulation::MotionPlayer& player, Done done) {
  simulation::ContactModel model;
  for (std::size_t k = 0; k < player.frame_count(); ++k) done(Timed(engine, player.Frame(k), model));
  return model;
}

int Run(const Options& options) {
  const Work work = MakeWork(options);
  std::vector<double> frame_us;
  std::map<std::string, std::vector<double>> pass_us;
  std::string name;
  simulation::ContactModel last;
  for (const bool time_passes : {false, true}) {
    auto engine = gpu::VulkanEngine::Create(work.bone, work.tool, Pose::Identity(), work.cutting,
                                            {.device = options.device, .time_passes = time_passes});
    if (!engine) throw std::runtime_error(engine.error());
    name = (*engine)->device();
    const auto done = [&](double took_us) {
      if (!time_passes) frame_us.push_back(took_us);
      for (const gpu::PassTime& pass : (*engine)->LastPassTimes())
        pass_us[pass.pass].push_back(pass.seconds * 1e6);
    };
    last = work.player ? Play(**engine, *work.player, done) : Ream(**engine, options.frames, done);
    if (last.status != simulation::EngineStatus::kOk) throw std::runtime_error("the last frame was refused");
  }
  double sum_us = 0.0;
  for (const double us : frame_us) sum_us += us;
  std::sort(frame_us.begin(), frame_us.end());
  if (work.player)
    std::printf(
        "device,scene,spheres,mass_points,frames,frames_per_s_mean,frame_us_p50,frame_us_p95,"
        "frame_us_p99,frame_us_p999,frame_us_max,removed_mm3");
  else
    std::printf(
        "device,spheres,mass_points,frames,frame_us_p50,frame_us_p95,frame_us_p99,frame_us_max,"
        "removed_mm3");
  for (const auto& [pass, times] : pass_us) std::printf(",%s_us_p50", pass.c_str());
  std::printf("\n\"%s\",", name.c_str());
  if (work.player) std::printf("\"%s\",", work.bone.name.c_str());
  std::printf("%zu,%zu,%zu,", work.bone.balls.size(), work.bone.points.size(), frame_us.size());
  if (work.player) std::printf("%.0f,", 1e6 * static_cast<double>(frame_us.size()) / sum_us);
  std::printf("%.1f,%.1f,%.1f,", At(frame_us, 0.5), At(frame_us, 0.95), At(frame_us, 0.99));
  if (work.player) std::printf("%.1f,", At(frame_us, 0.999));
  std::printf("%.1f,%.1f", frame_us.back(), last.removed_volume_m3 * 1e9);
  for (auto& [pass, times] : pass_us) {
    std::sort(times.begin(), times.end());
    std::printf(",%.1f", At(times, 0.5));
  }
  std::printf("\n");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (const std::string wrong = ReadOptions({argv + 1, argv + argc}, options); !wrong.empty()) {
    std::fprintf(
        stderr,
        "osteon_frame_bench: %s\nusage: osteon_frame_bench [FRAMES, at least 2] [FINENESS, 0.1 … 10] "
        "[DEVICE] [--device NAME]\n           [--scene CELL.yaml --motion FILE.csv] [--rate HZ, 10 … "
        "10000] [--spheres N, 100 … 10000000]\n",
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
