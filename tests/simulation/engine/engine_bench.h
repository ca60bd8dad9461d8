#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#ifdef OSTEON_TEST_CPU_ENGINE
#include "simulation/engine_cpu/cpu_engine.h"
#else
#include "gpu/engine/vulkan_engine.h"
#endif
#include "simulation/engine/reference_engine.h"
#include "simulation/packing/mass_points.h"
#include "simulation/solids/box_solid.h"
#include "simulation/tools/tool.h"

// Shared by the engines' tests: small scenes whose surfaces are known exactly, and a suite that runs on every
// engine. All lengths in metres; G and W coincide.

namespace osteon::simulation {

inline constexpr double kSpindle_rad_per_s = 250.0 * 2.0 * M_PI / 60.0;  // 250 rpm

/// Spacing and radius of the balls of AddBox.
inline constexpr double kLattice_m = 0.5e-3, kBallRadius_m = 0.75e-3;
/// Adds a box of equal balls on a cubic lattice to the bone, and mass points if asked for. The outer balls
/// touch the box's faces and are 0.5 mm apart. A tool of R >= 2 mm therefore sinks at most
/// 0.125 / (2 (R + r)) < 0.03 mm below a face (0.006 mm for R = 10 mm).
inline void AddBox(const Vector3& low, const Vector3& high, Bone& bone, bool with_points = true) {
  const Vector3 room = high - low - Vector3::Constant(2.0 * kBallRadius_m);
  Eigen::Vector3i count;
  for (int axis = 0; axis < 3; ++axis) {
    if (room[axis] < -1e-12) throw std::invalid_argument("box: thinner than a ball");
    count[axis] = static_cast<int>(std::ceil(room[axis] / kLattice_m - 1e-9)) + 1;
  }
  for (int k = 0; k < count.z(); ++k)
    for (int j = 0; j < count.y(); ++j)
      for (int i = 0; i < count.x(); ++i) {
        Vector3 c = low + Vector3::Constant(kBallRadius_m);
        const Eigen::Vector3i at(i, j, k);
        for (int axis = 0; axis < 3; ++axis)
          if (count[axis] > 1) c[axis] += room[axis] * at[axis] / (count[axis] - 1);
        bone.balls.push_back({.center_m = c, .radius_m = kBallRadius_m});
      }
  if (!with_points) return;
  const auto points = BuildMassPoints(BoxSolid(low, high), EverywhereZone(),
                                      {.cells = {.finest_m = 0.5e-3, .coarser_from_m = {}}});
  bone.points.insert(bone.points.end(), points.begin(), points.end());
}

/// Specific cutting energies u_c [J/m^3]: an assumed one of cancellous bone, and one of a softer bone in
/// which short runs cut deep.
inline constexpr double kSpongy = 60e6, kSoft = 4e6;

/// A bone of one material without friction, without balls and mass points.
inline Bone EmptyBone(double u_c = kSpongy) {
  Bone bone;
  bone.name = "test";
  bone.materials = {{.name = "test bone",
                     .density_kg_per_m3 = 500.0,
                     .specific_cutting_energy_J_per_m3 = u_c,
                     .cutting_force_ratio = 0.8,
                     .friction = 0.0}};
  return bone;
}

/// A square slab about the z axis with its top face at z = 0.
inline Bone Slab(double width_m, double thickness_m, bool with_points = true, double u_c = kSpongy) {
  Bone bone = EmptyBone(u_c);
  AddBox({-0.5 * width_m, -0.5 * width_m, -thickness_m}, {0.5 * width_m, 0.5 * width_m, 0.0}, bone,
         with_points);
  return bone;
}

/// A tool of one cutting ball whose apex is T's origin.
inline Tool BallTool(double radius_m) {
  Tool tool;
  tool.name = "ball";
  tool.balls = {{.center_m = Vector3(0, 0, -radius_m), .radius_m = radius_m, .cutting = true}};
  return tool;
}

/// X_WT of a tool whose z axis points straight down and is then rotated by a rotation vector; the apex is at
/// p.
inline Pose Down(const Vector3& p, const Vector3& turn = Vector3::Zero()) {
  Pose X = Pose::Identity();
  X.linear() = ExpRotation(turn) * ExpRotation({M_PI, 0, 0});
  X.translation() = p;
  return X;
}

/// A frame's input with the tool at this pose, by default with the spindle at rest.
inline FrameInput At(const Pose& X_WT, double spindle_rad_per_s = 0.0, double dt_s = 1e-3) {
  return {.X_WT = X_WT, .spindle_rad_per_s = spindle_rad_per_s, .dt_s = dt_s};
}

/// The engines that tests are run on. The CPU engine, with the best instruction set and others, has an
/// executable of its own (tests/simulation/engine_cpu), which needs no Vulkan.
enum class EngineKind { kReference, kVulkan, kCpu, kCpuAvx2, kCpuPlain };

inline std::string NameOfEngine(const testing::TestParamInfo<EngineKind>& info) {
  static constexpr const char* kNames[] = {"reference", "vulkan", "cpu", "cpu_avx2", "cpu_plain"};
  return kNames[static_cast<std::size_t>(info.param)];
}

#ifdef OSTEON_TEST_CPU_ENGINE
/// The engine that the reference engine is compared with.
inline constexpr EngineKind kOtherEngine = EngineKind::kCpu;
inline const auto kEveryEngine =
    testing::Values(EngineKind::kCpu, EngineKind::kCpuAvx2, EngineKind::kCpuPlain);

/// The CPU engine's instruction set for this kind: AVX2 or plain C++ if the processor has it, otherwise its
/// best set.
inline CpuParams CpuParamsOf(EngineKind kind) {
  const std::vector<std::string> sets = CpuInstructionSets();
  if (kind == EngineKind::kCpuPlain) return {.instruction_set = sets.back()};
  if (kind == EngineKind::kCpuAvx2 && std::find(sets.begin(), sets.end(), "N_AVX2") != sets.end())
    return {.instruction_set = "N_AVX2"};
  return {};
}
inline std::unique_ptr<CuttingEngine> MakeEngine(EngineKind kind, const Bone& bone, const Tool& tool,
                                                 const CuttingParams& params = {}) {
  if (kind == EngineKind::kReference)
    return std::make_unique<ReferenceEngine>(bone, tool, Pose::Identity(), params);
  return std::make_unique<CpuEngine>(bone, tool, Pose::Identity(), params, CpuParamsOf(kind));
}
#else
inline constexpr EngineKind kOtherEngine = EngineKind::kVulkan;
inline const auto kEveryEngine = testing::Values(EngineKind::kReference, EngineKind::kVulkan);

inline std::unique_ptr<CuttingEngine> MakeEngine(EngineKind kind, const Bone& bone, const Tool& tool,
                                                 const CuttingParams& params = {}) {
  if (kind == EngineKind::kReference)
    return std::make_unique<ReferenceEngine>(bone, tool, Pose::Identity(), params);
  auto engine = gpu::VulkanEngine::Create(bone, tool, Pose::Identity(), params, {});
  if (!engine) throw std::runtime_error(engine.error());
  return std::move(*engine);
}
#endif

/// Every test of this suite runs on every engine of the executable.
class Engine : public testing::TestWithParam<EngineKind> {
 protected:
  static std::unique_ptr<CuttingEngine> Make(const Bone& bone, const Tool& tool,
                                             const CuttingParams& params = {}) {
    return MakeEngine(GetParam(), bone, tool, params);
  }
};
#define OSTEON_ON_EVERY_ENGINE(suite) INSTANTIATE_TEST_SUITE_P(, suite, kEveryEngine, NameOfEngine)

/// Angle between two directions [deg].
inline double Degrees(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / M_PI;
}

}  // namespace osteon::simulation
