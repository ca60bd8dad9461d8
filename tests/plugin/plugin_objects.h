#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "plugin/include/osteon.h"

// Bones, tools and sessions for tests of the C interface: a block of balls and a ball that cuts.

namespace osteon::plugin {

struct Destroy {
  void operator()(OsteonBone* bone) const { osteon_bone_destroy(bone); }
  void operator()(OsteonTool* tool) const { osteon_tool_destroy(tool); }
  void operator()(OsteonSession* session) const { osteon_session_destroy(session); }
};
template <class T>
using Owned = std::unique_ptr<T, Destroy>;

#define EXPECT_OK(call) EXPECT_EQ((call), OSTEON_OK) << osteon_last_error()
#define ASSERT_OK(call) ASSERT_EQ((call), OSTEON_OK) << osteon_last_error()

inline const std::string& ConfigFolder() {
  static const std::string folder = OSTEON_SOURCE_DIR "/config";
  return folder;
}

/// Balls of 1 mm radius on a grid of 1 mm: 13 × 13 × 6 balls, the block's top at z = 1 mm.
inline Owned<OsteonBone> BlockOfBalls() {
  std::vector<float> balls;
  for (int z = -5; z <= 0; ++z)
    for (int y = -6; y <= 6; ++y)
      for (int x = -6; x <= 6; ++x)
        for (const float value : {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), 1.0F})
          balls.push_back(value);
  OsteonBoneParams params;
  osteon_bone_params_default(&params);
  params.balls_mm = balls.data();
  params.ball_count = balls.size() / 4;
  params.config_folder = ConfigFolder().c_str();
  params.site_axis[2] = 1.0;
  params.site_radius_m = 0.003;
  OsteonBone* bone = nullptr;
  EXPECT_OK(osteon_bone_create(OSTEON_ABI, &params, &bone));
  return Owned<OsteonBone>(bone);
}

/// One cutting ball around T's origin.
inline Owned<OsteonTool> BallTool(float radius_mm = 3.0F) {
  const std::array<float, 4> ball{0.0F, 0.0F, 0.0F, radius_mm};
  OsteonToolParams params;
  osteon_tool_params_default(&params);
  params.balls_mm = ball.data();
  params.ball_count = 1;
  OsteonTool* tool = nullptr;
  EXPECT_OK(osteon_tool_create(OSTEON_ABI, &params, &tool));
  return Owned<OsteonTool>(tool);
}

/// The CPU engine in lockstep.
inline OsteonSettings Lockstep(bool with_surface = true) {
  OsteonSettings settings;
  osteon_settings_default(&settings);
  settings.engine = OSTEON_ENGINE_CPU;
  settings.lockstep = 1;
  settings.surface = with_surface ? 1 : 0;
  return settings;
}

inline Owned<OsteonSession> MakeSession(const OsteonBone* bone, const OsteonTool* tool,
                                        const OsteonSettings& settings) {
  OsteonSession* session = nullptr;
  EXPECT_OK(osteon_session_create(OSTEON_ABI, bone, tool, &settings, &session));
  return Owned<OsteonSession>(session);
}

/// A pose with G's axes whose origin is at this height in G; the block's top is at 1 mm.
inline OsteonPose Above(double z_mm, double x_mm = 0.0) {
  return {.position_m = {1e-3 * x_mm, 0.0, 1e-3 * z_mm}, .orientation_wxyz = {1.0, 0.0, 0.0, 0.0}};
}

/// Feeds the tool of BallTool() from the height from_mm, clear of the block, down to `z_mm`, by 5 um in each
/// frame, in lockstep.
inline void FeedTo(OsteonSession* session, double z_mm, double from_mm = 4.2, double x_mm = 0.0) {
  for (double z = from_mm; z >= z_mm; z -= 0.005) {
    const OsteonPose pose = Above(z, x_mm);
    ASSERT_OK(osteon_session_step(session, &pose, 100.0, 0.001));
  }
}

inline OsteonFigures FiguresOf(OsteonSession* session) {
  OsteonFigures figures{};
  EXPECT_OK(osteon_session_figures(session, &figures));
  return figures;
}

}  // namespace osteon::plugin
