// Times cutting frames on one Vulkan device: a 50 mm reamer pressed into the generated acetabulum. Links
// little more than the Vulkan loader, so that the executable travels to a machine with a GPU.
//
//     osteon_frame_bench [FRAMES] [FINENESS] [DEVICE]
//
// FINENESS divides the packing's and the points' finest spacing. Prints a CSV header and one row; times are
// wall time around CuttingEngine::Step, and the device's own by pass in a second run (timestamps slow
// software drivers down).

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "gpu/vulkan_engine.h"
#include "simulation/acetabulum_solid.h"
#include "simulation/mass_points.h"
#include "simulation/packing_builder.h"

namespace {

using namespace osteon;

simulation::Bone MakeBone(double fineness) {
  const simulation::AcetabulumSolid solid({});
  simulation::PackingParams packing;
  packing.lattice.finest_m /= fineness;
  packing.cup_radius_cap_m /= fineness;
  packing.least_radius_m /= fineness;
  packing.surface_gap_m /= fineness;
  packing.samples.finest_m /= fineness;
  simulation::MassPointParams points;
  points.cells.finest_m /= fineness;
  simulation::Bone bone;
  bone.name = "acetabulum";
  bone.balls = BuildPacking(solid, simulation::CupZone(solid.cup()), packing);
  bone.points = BuildMassPoints(solid, simulation::CupZone(solid.cup()), points);
  bone.materials = {
      {.name = "cartilage", .density_kg_per_m3 = 1100, .specific_cutting_energy_J_per_m3 = 2e7},
      {.name = "cortical", .density_kg_per_m3 = 1850, .specific_cutting_energy_J_per_m3 = 1.3e9},
      {.name = "cancellous", .density_kg_per_m3 = 300, .specific_cutting_energy_J_per_m3 = 6e7}};
  bone.cup = solid.cup();
  return bone;
}

double At(std::vector<double>& sorted, double share) {
  return sorted[std::min(sorted.size() - 1,
                         static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
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
    const auto start = std::chrono::steady_clock::now();
    model = engine.Step({.X_WT = X_WT,
                         .spindle_rad_per_s = 250.0 * 2.0 * std::numbers::pi / 60.0,
                         .dt_s = kStep_s,
                         .stamp = k});
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    if (k >= frames / 2) done(took.count());
  }
  return model;
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 2000;
  const double fineness = argc > 2 ? std::atof(argv[2]) : 1.0;
  const std::string device = argc > 3 ? argv[3] : "";
  if (frames < 2 || !(fineness > 0.1 && fineness < 10.0)) {
    std::fprintf(stderr, "usage: osteon_frame_bench [FRAMES, at least 2] [FINENESS, 0.1 … 10] [DEVICE]\n");
    return 2;
  }
  const simulation::Bone bone = MakeBone(fineness);
  const simulation::Tool tool = simulation::MakeReamer(0.025, 0.008, 0.12, 0.9, Vector3(0, 0, -0.025));
  std::vector<double> frame_us;
  std::map<std::string, std::vector<double>> pass_us;
  std::string name;
  double removed_mm3 = 0.0;
  for (const bool time_passes : {false, true}) {
    auto engine = gpu::VulkanEngine::Create(bone, tool, Pose::Identity(), {},
                                            {.device = device, .time_passes = time_passes});
    if (!engine) {
      std::fprintf(stderr, "osteon_frame_bench: %s\n", engine.error().c_str());
      return 1;
    }
    name = (*engine)->device();
    const simulation::ContactModel last = Ream(**engine, frames, [&](double took_us) {
      if (!time_passes) frame_us.push_back(took_us);
      for (const gpu::PassTime& pass : (*engine)->LastPassTimes())
        pass_us[pass.pass].push_back(pass.seconds * 1e6);
    });
    removed_mm3 = last.removed_volume_m3 * 1e9;
  }
  std::sort(frame_us.begin(), frame_us.end());
  std::printf(
      "device,spheres,mass_points,frames,frame_us_p50,frame_us_p95,frame_us_p99,frame_us_max,removed_mm3");
  for (const auto& [pass, times] : pass_us) std::printf(",%s_us_p50", pass.c_str());
  std::printf("\n\"%s\",%zu,%zu,%zu,%.1f,%.1f,%.1f,%.1f,%.1f", name.c_str(), bone.balls.size(),
              bone.points.size(), frame_us.size(), At(frame_us, 0.5), At(frame_us, 0.95), At(frame_us, 0.99),
              frame_us.back(), removed_mm3);
  for (auto& [pass, times] : pass_us) {
    std::sort(times.begin(), times.end());
    std::printf(",%.1f", At(times, 0.5));
  }
  std::printf("\n");
  return 0;
}
