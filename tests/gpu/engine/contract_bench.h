#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "gpu/engine/vulkan_engine.h"
#include "simulation/bone/scenes.h"

// Shared parts of the engine tests: the default bone and reamer, a hand that presses the reamer into the
// bone, a tool of many balls, and a function that opens a Vulkan engine.

namespace osteon::gpu {

inline constexpr double kSpindle_rad_per_s = 250.0 * 2.0 * M_PI / 60.0;  ///< 250 revolutions per minute

inline simulation::Bone DefaultBone() {
  static const simulation::Bone bone = simulation::MakeAcetabulum({});
  return bone;
}
inline simulation::Tool DefaultReamer() {
  return simulation::MakeReamer(0.025, 0.008, 0.12, 0.9, Vector3::Zero());
}

/// A hand that pushes the tool into the cup: a damped admittance along the axis, a slow tilt, and sideways
/// motion of some tenths of a millimetre. The hand reacts to the force of one engine. A second engine can be
/// given the same poses.
class Hand {
 public:
  /// The next frame's input. @param f_W  force of the engine in the previous frame
  simulation::FrameInput Next(const Vector3& f_W) {
    const double t = frame_++ * kDt;
    // the push rises to 130 N within 0.15 s. The damping of 600 N s/m and the stiffness of 20 N/mm give a
    // slow pole at 33 per second
    const double push_N = std::min(130.0, 130.0 * t / 0.15);
    depth_m_ += kDt * (push_N - f_W.z()) / 600.0;
    Pose X_WT = Pose::Identity();
    const Vector3 turn(0.10 * std::sin(4.0 * t), 0.06 * (1.0 - std::cos(5.0 * t)), 0.0);
    X_WT.linear() = ExpRotation(turn) * ExpRotation({M_PI, 0, 0});
    // the tool rotates about its head's centre
    const Vector3 head(0.3e-3 * std::sin(7.0 * t), 0.2e-3 * std::sin(5.0 * t), kStart_m - depth_m_);
    X_WT.translation() = head + X_WT.linear() * Vector3(0, 0, 0.025);
    return {.X_WT = X_WT, .spindle_rad_per_s = kSpindle_rad_per_s, .dt_s = kDt};
  }

  static constexpr double kDt = 1e-3;  ///< period of a frame [s]
  /// Initial height of the head's centre above the bone's top face. At 7.0 mm, a head of 25 mm rests on the
  /// rim of the cup of 24 mm; the start is 0.05 mm higher.
  static constexpr double kStart_m = 7.05e-3;

 private:
  double depth_m_{0.0};
  int frame_{0};
};

/// A hemisphere of many balls, as in a tool that was fitted: the balls at the rim and at the pole extend
/// farthest. Every fifth ball does not cut.
inline simulation::Tool Shell(int count) {
  simulation::Tool tool;
  const double radius_m = 6e-3, ball_m = 0.8e-3, golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = (i + 0.5) / count, r = std::sqrt(1.0 - z * z);
    tool.balls.push_back({.center_m = Vector3((radius_m - ball_m) * r * std::cos(golden * i),
                                              (radius_m - ball_m) * r * std::sin(golden * i),
                                              -radius_m + (radius_m - ball_m) * z),
                          .radius_m = ball_m,
                          .cutting = i % 5 != 0});
  }
  return tool;
}

/// Opens an engine for a bone whose pose is the identity. @throws std::runtime_error with the reason if the
/// engine does not open
inline std::unique_ptr<VulkanEngine> Open(const simulation::Bone& bone, const simulation::Tool& tool,
                                          const VulkanParams& vulkan = {},
                                          const simulation::CuttingParams& params = {}) {
  auto engine = VulkanEngine::Create(bone, tool, Pose::Identity(), params, vulkan);
  if (!engine) throw std::runtime_error(engine.error());
  return std::move(*engine);
}

}  // namespace osteon::gpu
