#include "plugin/include/osteon.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/utf8.h"
#include "tests/plugin/plugin_objects.h"
#include "tests/temporary_path.h"

// The C interface, called by a careless or hostile program.

namespace osteon::plugin {
namespace {

// Parameters that are all zero except the config folder.
template <class T>
T Params() {
  T params{};
  params.config_folder = ConfigFolder().c_str();
  return params;
}

// A save consists of two files, NAME and NAME.swept. If either cannot be written, neither is left.
TEST(OsteonSession, ASaveThatFailsLeavesNoFile) {
  namespace fs = std::filesystem;
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep());
  const fs::path folder = TemporaryPath("saves");
  fs::create_directories(folder / "taken");
  EXPECT_EQ(osteon_session_save(session.get(), (folder / "taken").c_str()), OSTEON_ERROR_FILE);
  EXPECT_STREQ(osteon_last_error(), ((folder / "taken").string() +
                                     ": found a folder, accepted a new name, or a regular file to replace")
                                        .c_str());
  EXPECT_EQ(osteon_session_save(session.get(), ""), OSTEON_ERROR_ARGUMENT);
  fs::create_directories(folder / "a.state.swept");
  EXPECT_EQ(osteon_session_save(session.get(), (folder / "a.state").c_str()), OSTEON_ERROR_FILE);
  EXPECT_EQ(osteon_session_save(session.get(), "/dev/null"), OSTEON_ERROR_FILE) << "a device holds no bone";
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::ranges::sort(names);
  EXPECT_EQ(names, (std::vector<std::string>{"a.state.swept", "taken"}));
}

// A first pose in bone is refused. A later change of tool at a free pose must nevertheless begin the session.
TEST(OsteonSession, BeginsWithAChangeOfToolAfterAFirstPoseInBone) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep(false));
  const OsteonPose inside = Above(1.0), free = Above(5.0);
  ASSERT_EQ(osteon_session_step(session.get(), &inside, 0.0, 0.001), OSTEON_ERROR_STATE);
  ASSERT_OK(osteon_session_change_tool(session.get(), tool.get(), &free));
  EXPECT_OK(osteon_session_step(session.get(), &free, 0.0, 0.001));
  EXPECT_GT(FiguresOf(session.get()).frame, 1U);
}

// Positions beyond 1 km are refused: floats are too coarse there, so all of the engine's boxes would be near.
TEST(OsteonSession, RefusesPosesThatAreTooFar) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep(false));
  const OsteonPose free = Above(4.2);
  ASSERT_OK(osteon_session_step(session.get(), &free, 0.0, 0.001));
  OsteonWrench wrench;
  for (const double far_m : {1000.1, -1e9, 1e30, -1e300}) {
    SCOPED_TRACE(far_m);
    for (int axis = 0; axis < 3; ++axis) {
      OsteonPose pose = free;
      pose.position_m[axis] = far_m;
      EXPECT_EQ(osteon_session_step(session.get(), &pose, 0.0, 0.001), OSTEON_ERROR_ARGUMENT);
      EXPECT_EQ(osteon_session_evaluate(session.get(), &pose, nullptr, &wrench), OSTEON_ERROR_ARGUMENT);
    }
  }
  OsteonPose away = free;
  away.position_m[0] = 1000.0;
  EXPECT_OK(osteon_session_step(session.get(), &away, 0.0, 0.001));
  EXPECT_OK(osteon_session_step(session.get(), &free, 0.0, 0.001));
}

// A forked child lacks the threads that pack a bone: without a refusal the call would wait forever.
TEST(OsteonLibrary, RefusesToMakeObjectsInAForkedChild) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const pid_t child = fork();
  if (child == 0) {
    OsteonBone* other_bone = nullptr;
    OsteonTool* other_tool = nullptr;
    OsteonPlan* plan = nullptr;
    OsteonSession* session = nullptr;
    const auto bone_params = Params<OsteonBoneParams>();
    const auto tool_params = Params<OsteonToolParams>();
    const auto plan_params = Params<OsteonPlanParams>();
    const OsteonSettings settings = Lockstep(false);
    const bool refused =
        osteon_bone_create(OSTEON_ABI, &bone_params, &other_bone) == OSTEON_ERROR_FORK &&
        osteon_tool_create(OSTEON_ABI, &tool_params, &other_tool) == OSTEON_ERROR_FORK &&
        osteon_plan_create(OSTEON_ABI, &plan_params, &plan) == OSTEON_ERROR_FORK &&
        osteon_session_create(OSTEON_ABI, bone.get(), tool.get(), &settings, &session) == OSTEON_ERROR_FORK;
    _exit(refused ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

TEST(OsteonLibrary, ErrorTextsAreOneLineOfUtf8) {
  OsteonBone* bone = nullptr;
  auto params = Params<OsteonBoneParams>();
  params.scene = "a\r\x1b[31m\xff\nb";
  EXPECT_EQ(osteon_bone_create(OSTEON_ABI, &params, &bone), OSTEON_ERROR_FILE);
  EXPECT_NE(std::string(osteon_last_error()).find("a??[31m? b.yaml"), std::string::npos)
      << osteon_last_error();
  // A long text is cut off. With one of these two prefixes the cut falls in the middle of a two-byte
  // character.
  for (const char* shift : {"", "x"}) {
    std::string name = shift;
    for (int i = 0; i < 900; ++i) name += "é";
    params.scene = name.c_str();
    EXPECT_EQ(osteon_bone_create(OSTEON_ABI, &params, &bone), OSTEON_ERROR_FILE);
    const std::string text = osteon_last_error();
    EXPECT_EQ(base::Utf8(text), text);
    EXPECT_GE(text.size(), 1022u);
  }
}

TEST(OsteonLibrary, RefusesSitesAndCountsBeyondAnyBone) {
  const std::array<float, 4> ball{0.0F, 0.0F, 0.0F, 5.0F};
  OsteonBone* bone = nullptr;
  auto params = Params<OsteonBoneParams>();
  params.balls_mm = ball.data();
  params.ball_count = SIZE_MAX;
  EXPECT_EQ(osteon_bone_create(OSTEON_ABI, &params, &bone), OSTEON_ERROR_ARGUMENT) << osteon_last_error();
  OsteonTool* tool = nullptr;
  auto tool_params = Params<OsteonToolParams>();
  tool_params.balls_mm = ball.data();
  tool_params.ball_count = SIZE_MAX;
  EXPECT_EQ(osteon_tool_create(OSTEON_ABI, &tool_params, &tool), OSTEON_ERROR_ARGUMENT)
      << osteon_last_error();
  params.ball_count = 1;
  params.site_axis[0] = 1e300;  // an axis of any length is accepted
  params.site_radius_m = 1e300;
  EXPECT_EQ(osteon_bone_create(OSTEON_ABI, &params, &bone), OSTEON_ERROR_ARGUMENT);
  params.site_radius_m = 0.005;
  params.site_center_m[1] = 1e300;
  EXPECT_EQ(osteon_bone_create(OSTEON_ABI, &params, &bone), OSTEON_ERROR_ARGUMENT);
  params.site_center_m[1] = 0.0;
  ASSERT_OK(osteon_bone_create(OSTEON_ABI, &params, &bone));
  const Owned<OsteonBone> made(bone);
  OsteonBoneInfo info;
  ASSERT_OK(osteon_bone_info(bone, &info));
  EXPECT_EQ(info.site_axis[0], 1.0) << "a unit vector, whatever the length";
}

// Balls that are metres apart do not fit into a grid of bricks. The session then has no surface, and the
// error must state the reason.
TEST(OsteonSession, SaysWhyItHasNoSurface) {
  const std::array<float, 8> balls{-1e4F, -1e4F, -1e4F, 2.0F, 1e4F, 1e4F, 1e4F, 2.0F};
  auto params = Params<OsteonBoneParams>();
  params.balls_mm = balls.data();
  params.ball_count = 2;
  OsteonBone* made = nullptr;
  ASSERT_OK(osteon_bone_create(OSTEON_ABI, &params, &made));
  const Owned<OsteonBone> bone(made);
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep());
  EXPECT_EQ(osteon_session_surface_wait(session.get()), OSTEON_ERROR_STATE);
  EXPECT_NE(std::string(osteon_last_error()).find("voxel: found"), std::string::npos) << osteon_last_error();
}

TEST(OsteonSession, HasNoProxyBeforeItsFirstFrame) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep(false));
  const OsteonPose proxy = FiguresOf(session.get()).proxy;
  for (const double value : proxy.orientation_wxyz) EXPECT_EQ(value, 0.0);
  const OsteonPose free = Above(4.2);
  ASSERT_OK(osteon_session_step(session.get(), &free, 0.0, 0.001));
  EXPECT_EQ(FiguresOf(session.get()).proxy.orientation_wxyz[0], 1.0);
}

TEST(OsteonSession, SwallowsAnExceptionOfALogCallback) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep(false));
  const auto callback = [](void*, std::uint32_t, const char*) { throw 1; };
  EXPECT_OK(osteon_session_set_log(session.get(), callback, nullptr));
}

}  // namespace
}  // namespace osteon::plugin
