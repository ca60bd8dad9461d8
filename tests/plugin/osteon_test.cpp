#include "plugin/include/osteon.h"

#include <dlfcn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "control/coupling/virtual_coupling.h"
#include "simulation/bone/scenes.h"
#include "simulation/engine_cpu/cpu_engine.h"
#include "tests/plugin/plugin_objects.h"
#include "tests/temporary_path.h"

// The C interface as a program uses it, in lockstep: no test depends on wall time.

namespace osteon::plugin {
namespace {

// Sizes and offsets of the ABI: a change here needs a new OSTEON_ABI.
static_assert(OSTEON_ABI == 1);
static_assert(sizeof(OsteonPose) == 56 && sizeof(OsteonTwist) == 48 && sizeof(OsteonWrench) == 48);
static_assert(sizeof(OsteonBoneParams) == 120 && sizeof(OsteonBoneInfo) == 96);
static_assert(sizeof(OsteonToolParams) == 48 && sizeof(OsteonSettings) == 56);
static_assert(sizeof(OsteonFigures) == 192 && sizeof(OsteonEvent) == 88);
static_assert(sizeof(OsteonVertex) == 28 && sizeof(OsteonChunk) == 24 && sizeof(OsteonSurfaceBuffers) == 80);
static_assert(offsetof(OsteonFigures, proxy) == 24 && offsetof(OsteonFigures, contacts) == 176);
static_assert(offsetof(OsteonSettings, max_force_N) == 24 && offsetof(OsteonBoneParams, balls_mm) == 32);

double ForceOf(const OsteonWrench& wrench) {
  return std::hypot(wrench.force_N[0], wrench.force_N[1], wrench.force_N[2]);
}

TEST(OsteonLibrary, RefusesAnotherAbiAndNamesBothNumbers) {
  OsteonBoneParams params;
  osteon_bone_params_default(&params);
  OsteonBone* bone = reinterpret_cast<OsteonBone*>(1);
  EXPECT_EQ(osteon_bone_create(OSTEON_ABI + 1, &params, &bone), OSTEON_ERROR_ABI);
  EXPECT_EQ(bone, nullptr);
  const std::string text = osteon_last_error();
  EXPECT_NE(text.find("ABI 2"), std::string::npos) << text;
  EXPECT_NE(text.find("ABI 1"), std::string::npos) << text;
  EXPECT_EQ(osteon_abi(), OSTEON_ABI);
  EXPECT_STREQ(osteon_version(), OSTEON_VERSION);
}

TEST(OsteonLibrary, ReturnsAnErrorForNullPointers) {
  EXPECT_EQ(osteon_bone_create(OSTEON_ABI, nullptr, nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_tool_create(OSTEON_ABI, nullptr, nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_session_create(OSTEON_ABI, nullptr, nullptr, nullptr, nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_session_set_tool_pose(nullptr, nullptr, 0.0), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_session_step(nullptr, nullptr, 0.0, 0.0), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_session_evaluate(nullptr, nullptr, nullptr, nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_session_figures(nullptr, nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_session_next_event(nullptr, nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_session_mark(nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_session_undo(nullptr, nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_session_save(nullptr, nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_session_restore(nullptr, nullptr, nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_session_surface_changes(nullptr, nullptr, nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_bone_info(nullptr, nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_bone_approach(nullptr, 0.0, nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_bone_material(nullptr, 0), nullptr);
  EXPECT_EQ(osteon_bone_material_color(nullptr, 0, nullptr), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_session_set_log(nullptr, nullptr, nullptr), OSTEON_ERROR_ARGUMENT);
  osteon_bone_destroy(nullptr);
  osteon_tool_destroy(nullptr);
  osteon_session_destroy(nullptr);
}

TEST(OsteonLibrary, HasAColourForEachMaterial) {
  const auto bone = BlockOfBalls();
  OsteonBoneInfo info{};
  ASSERT_OK(osteon_bone_info(bone.get(), &info));
  ASSERT_EQ(info.material_count, 1U);
  std::array<std::uint8_t, 3> rgb{};
  ASSERT_OK(osteon_bone_material_color(bone.get(), 0, rgb.data()));
  EXPECT_EQ(rgb, (std::array<std::uint8_t, 3>{224, 163, 128})) << "cancellous bone, reddish-yellow";
  EXPECT_EQ(osteon_bone_material_color(bone.get(), 1, rgb.data()), OSTEON_ERROR_ARGUMENT);
  EXPECT_NE(std::string(osteon_last_error()).find("found 1, accepted 0"), std::string::npos);
}

TEST(OsteonLibrary, NamesWhatIsWrongWithABone) {
  const auto refused = [](OsteonResult code, const std::string& text, const auto& change) {
    OsteonBoneParams params;
    osteon_bone_params_default(&params);
    params.config_folder = ConfigFolder().c_str();
    change(params);
    OsteonBone* bone = nullptr;
    EXPECT_EQ(osteon_bone_create(OSTEON_ABI, &params, &bone), code);
    EXPECT_EQ(bone, nullptr);
    EXPECT_NE(std::string(osteon_last_error()).find(text), std::string::npos) << osteon_last_error();
  };
  const float bad[] = {0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, std::nanf("")};
  refused(OSTEON_ERROR_FILE, "acetabulum", [](auto& p) { p.scene = "no_such_scene"; });
  refused(OSTEON_ERROR_FILE, "no_such.osp", [](auto& p) { p.packing_file = "no_such.osp"; });
  refused(OSTEON_ERROR_ARGUMENT, "site_radius_m", [](auto& p) { p.mesh_file = "no_such.stl"; });
  refused(OSTEON_ERROR_ARGUMENT, "accepted one",
          [&](auto& p) { p.mesh_file = "a.stl", p.packing_file = "b.osp"; });
  refused(OSTEON_ERROR_ARGUMENT, "ball 1", [&](auto& p) { p.balls_mm = bad, p.ball_count = 2; });
  refused(OSTEON_ERROR_ARGUMENT, "ball_count", [&](auto& p) { p.balls_mm = bad; });
  refused(OSTEON_ERROR_FILE, "unobtainium",
          [&](auto& p) { p.balls_mm = bad, p.ball_count = 1, p.material = "unobtainium"; });
  refused(OSTEON_ERROR_FILE, "no_such_folder", [](auto& p) { p.config_folder = "no_such_folder"; });
  refused(OSTEON_ERROR_ARGUMENT, "site: found", [](auto& p) {
    p.site_radius_m = 0.01;  // the site's axis is zero
  });
}

TEST(OsteonLibrary, NamesTheFieldOfAnUnavailableToolSize) {
  OsteonToolParams params;
  osteon_tool_params_default(&params);
  params.config_folder = ConfigFolder().c_str();
  params.diameter_m = 0.0511;
  OsteonTool* tool = nullptr;
  EXPECT_EQ(osteon_tool_create(OSTEON_ABI, &params, &tool), OSTEON_ERROR_ARGUMENT);
  const std::string text = osteon_last_error();
  EXPECT_TRUE(text.starts_with("diameter_m, in mm: found 51.1, accepted ")) << text;
}

TEST(OsteonLibrary, NamesWhatIsWrongWithASession) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto refused = [&](const std::string& text, const auto& change) {
    OsteonSettings settings = Lockstep();
    change(settings);
    OsteonSession* session = nullptr;
    EXPECT_LT(osteon_session_create(OSTEON_ABI, bone.get(), tool.get(), &settings, &session), OSTEON_OK);
    EXPECT_EQ(session, nullptr);
    EXPECT_NE(std::string(osteon_last_error()).find(text), std::string::npos) << osteon_last_error();
  };
  refused("max_force_N", [](auto& s) { s.max_force_N = 200.1; });
  refused("max_force_N", [](auto& s) { s.max_force_N = std::nan(""); });
  refused("max_torque_Nm", [](auto& s) { s.max_torque_Nm = 0.0; });
  refused("stiffness_N_per_m", [](auto& s) { s.stiffness_N_per_m = -1.0; });
  refused("engine", [](auto& s) { s.engine = 7; });
  refused("no_such_gpu", [](auto& s) { s.engine = OSTEON_ENGINE_VULKAN, s.device = "no_such_gpu"; });
}

TEST(OsteonSession, RefusesToBeginInBone) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep());
  const OsteonPose inside = Above(2.0), free = Above(4.2);
  EXPECT_EQ(osteon_session_step(session.get(), &inside, 100.0, 0.001), OSTEON_ERROR_STATE);
  EXPECT_NE(std::string(osteon_last_error()).find("2.00 mm in bone"), std::string::npos)
      << osteon_last_error();
  EXPECT_OK(osteon_session_step(session.get(), &free, 100.0, 0.001));
  EXPECT_EQ(FiguresOf(session.get()).frame, 1U);
}

TEST(OsteonSession, WritesEventsToItsLog) {
  struct Line {
    std::uint32_t level;
    std::string text;
  };
  std::vector<Line> lines;
  const auto keep = [](void* user, std::uint32_t level, const char* text) {
    static_cast<std::vector<Line>*>(user)->push_back({level, text});
  };
  const auto bone = BlockOfBalls();
  const auto tool = BallTool(), other = BallTool(2.0F);
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep(false));
  ASSERT_OK(osteon_session_set_log(session.get(), keep, &lines));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].text.find("cpu"), std::string::npos) << lines[0].text;
  EXPECT_EQ(lines[0].level, static_cast<std::uint32_t>(OSTEON_LOG_INFO));
  const OsteonPose inside = Above(2.0), free = Above(4.2);
  EXPECT_EQ(osteon_session_step(session.get(), &inside, 100.0, 0.001), OSTEON_ERROR_STATE);
  EXPECT_EQ(osteon_session_step(session.get(), &inside, 100.0, 0.001), OSTEON_ERROR_STATE);
  ASSERT_EQ(lines.size(), 2U) << "one warning, not one a frame";
  EXPECT_EQ(lines[1].level, static_cast<std::uint32_t>(OSTEON_LOG_WARNING));
  EXPECT_NE(lines[1].text.find("2.00 mm in bone"), std::string::npos) << lines[1].text;
  ASSERT_OK(osteon_session_step(session.get(), &free, 100.0, 0.001));
  ASSERT_OK(osteon_session_change_tool(session.get(), other.get(), &free));
  ASSERT_EQ(lines.size(), 3U);
  ASSERT_OK(osteon_session_set_log(session.get(), nullptr, nullptr));
  ASSERT_OK(osteon_session_change_tool(session.get(), tool.get(), &free));
  EXPECT_EQ(lines.size(), 3U) << "nobody is told any more";
}

// At the same poses, engine and coupling of the servo loop give the wrench that the session gives.
TEST(OsteonSession, WrenchEqualsThatOfTheServoLoop) {
  OsteonBoneParams params;
  osteon_bone_params_default(&params);
  params.config_folder = ConfigFolder().c_str();
  OsteonBone* made_bone = nullptr;
  ASSERT_OK(osteon_bone_create(OSTEON_ABI, &params, &made_bone));
  const Owned<OsteonBone> bone(made_bone);
  OsteonToolParams tool_params;
  osteon_tool_params_default(&tool_params);
  tool_params.config_folder = ConfigFolder().c_str();
  OsteonTool* made_tool = nullptr;
  ASSERT_OK(osteon_tool_create(OSTEON_ABI, &tool_params, &made_tool));
  const Owned<OsteonTool> tool(made_tool);
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep(false));

  simulation::SceneParams scene = config::LoadScene(ConfigFolder() + "/scenes/acetabulum.yaml");
  const auto materials = config::LoadMaterials(ConfigFolder() + "/materials/bone.yaml");
  for (const std::string& name : scene.material_names)
    scene.materials.push_back(*std::find_if(materials.begin(), materials.end(),
                                            [&](const auto& material) { return material.name == name; }));
  const simulation::Bone packed = simulation::PackScene(simulation::MakeSceneSolid(scene), scene);
  const config::ToolConfig reamer = config::LoadTool(ConfigFolder() + "/tools/reamer.yaml");
  simulation::CpuEngine engine(packed, reamer.tool, Pose::Identity(), {});
  control::CouplingState state;

  double largest_N = 0.0;
  rt::Nanoseconds now = 1;
  for (int ms = 0; ms < 3000; ++ms) {
    OsteonPose pose;
    ASSERT_OK(osteon_bone_approach(bone.get(), -0.017 - 0.003e-3 * ms, &pose));
    ASSERT_OK(osteon_session_step(session.get(), &pose, reamer.spindle_rad_per_s, 0.001));
    const OsteonTwist twist{.linear_m_per_s = {0.0, 0.0, -0.003}, .angular_rad_per_s = {}};
    OsteonWrench wrench;
    ASSERT_OK(osteon_session_evaluate(session.get(), &pose, &twist, &wrench));

    now += 1'000'000;
    Pose X_GT = Pose::Identity();
    const auto& q = pose.orientation_wxyz;
    X_GT.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
    X_GT.translation() = Vector3(pose.position_m[0], pose.position_m[1], pose.position_m[2]);
    const simulation::ContactModel model = engine.Step(
        {.X_WT = X_GT, .spindle_rad_per_s = reamer.spindle_rad_per_s, .dt_s = 0.001, .stamp = now});
    const Wrench F = control::EvaluateCoupling({},
                                               {.model = model,
                                                .X_WT = X_GT,
                                                .V_WT = {.v = Vector3(0, 0, -0.003), .w = Vector3::Zero()},
                                                .now = now,
                                                .spindle_turns = true},
                                               state)
                         .F_T_W;
    for (int i = 0; i < 3; ++i) {
      ASSERT_NEAR(wrench.force_N[i], F.f[i], 1e-12) << ms << " ms";
      ASSERT_NEAR(wrench.torque_Nm[i], F.t[i], 1e-12) << ms << " ms";
    }
    largest_N = std::max(largest_N, ForceOf(wrench));
  }
  EXPECT_GT(largest_N, 20.0);
  EXPECT_GT(FiguresOf(session.get()).removed_volume_m3, 5e-7);
}

TEST(OsteonSession, WrenchNeverExceedsItsLimit) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  OsteonSettings settings = Lockstep(false);
  settings.max_force_N = 30.0;
  const auto session = MakeSession(bone.get(), tool.get(), settings);
  double largest_N = 0.0;
  for (double z = 4.2; z > -2.0; z -= 0.01) {  // the spindle stands still, so the bone stops the tool
    const OsteonPose pose = Above(z);
    ASSERT_OK(osteon_session_step(session.get(), &pose, 0.0, 0.001));
    OsteonWrench wrench;
    ASSERT_OK(osteon_session_evaluate(session.get(), &pose, nullptr, &wrench));
    largest_N = std::max(largest_N, ForceOf(wrench));
  }
  EXPECT_LE(largest_N, 30.0);
  EXPECT_GT(largest_N, 29.9);
  // a pose that is not finite gives no force
  OsteonPose nowhere = Above(1.0);
  nowhere.position_m[0] = std::numeric_limits<double>::quiet_NaN();
  OsteonWrench wrench{.force_N = {1.0, 1.0, 1.0}, .torque_Nm = {}};
  EXPECT_EQ(osteon_session_evaluate(session.get(), &nowhere, nullptr, &wrench), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(ForceOf(wrench), 0.0);
  EXPECT_EQ(osteon_session_step(session.get(), &nowhere, 0.0, 0.001), OSTEON_ERROR_ARGUMENT);
}

/// Returns the bits of all triangles' corner positions for each brick: those in `kept`, updated by the
/// changes since `generation`.
std::map<std::uint32_t, std::vector<std::uint32_t>> UpdatedSurface(
    OsteonSession* session, std::uint64_t& generation,
    std::map<std::uint32_t, std::vector<std::uint32_t>> kept) {
  EXPECT_OK(osteon_session_surface_wait(session));
  std::vector<OsteonChunk> chunks(64);
  std::vector<OsteonVertex> vertices(3 * OSTEON_CHUNK_MAX_VERTICES);
  std::vector<std::uint16_t> indices(3 * OSTEON_CHUNK_MAX_INDICES);
  OsteonSurfaceBuffers buffers{};
  buffers.chunks = chunks.data();
  buffers.vertices = vertices.data();
  buffers.indices = indices.data();
  buffers.chunk_capacity = chunks.size();
  buffers.vertex_capacity = vertices.size();
  buffers.index_capacity = indices.size();
  do {
    EXPECT_OK(osteon_session_surface_changes(session, &generation, &buffers));
    for (std::size_t c = 0; c < buffers.chunk_count; ++c) {
      const OsteonChunk& chunk = chunks[c];
      std::vector<std::uint32_t> bits;
      for (std::uint32_t i = 0; i < chunk.index_count; ++i) {
        const std::uint16_t index = indices[chunk.first_index + i];
        EXPECT_LT(index, chunk.vertex_count);
        for (const float x : vertices[chunk.first_vertex + index].position_mm)
          bits.push_back(std::bit_cast<std::uint32_t>(x));
      }
      if (bits.empty())
        kept.erase(chunk.brick);
      else
        kept[chunk.brick] = bits;
    }
  } while (buffers.left > 0);
  return kept;
}

std::size_t Triangles(const std::map<std::uint32_t, std::vector<std::uint32_t>>& surface) {
  std::size_t count = 0;
  for (const auto& [brick, bits] : surface) count += bits.size() / 9;
  return count;
}

TEST(OsteonSession, EqualRunsGiveEqualBits) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  std::vector<OsteonFigures> figures;
  std::vector<std::map<std::uint32_t, std::vector<std::uint32_t>>> surfaces;
  for (int run = 0; run < 2; ++run) {
    const auto session = MakeSession(bone.get(), tool.get(), Lockstep());
    FeedTo(session.get(), 2.5);
    figures.push_back(FiguresOf(session.get()));
    std::uint64_t generation = 0;
    surfaces.push_back(UpdatedSurface(session.get(), generation, {}));
  }
  EXPECT_EQ(std::memcmp(&figures[0], &figures[1], sizeof figures[0]), 0);
  EXPECT_EQ(surfaces[0], surfaces[1]);
  EXPECT_GT(Triangles(surfaces[0]), 1000U);
}

TEST(OsteonSession, HandsOutOnlyChangedBricks) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep());
  const OsteonPose free = Above(4.2);
  ASSERT_OK(osteon_session_step(session.get(), &free, 0.0, 0.001));
  std::uint64_t generation = 0;
  const auto uncut = UpdatedSurface(session.get(), generation, {});
  const std::uint64_t before = generation;
  EXPECT_EQ(UpdatedSurface(session.get(), generation, uncut), uncut);
  EXPECT_EQ(generation, before) << "nothing changed";
  FeedTo(session.get(), 2.5);
  const auto cut = UpdatedSurface(session.get(), generation, uncut);
  EXPECT_NE(cut, uncut);
  std::uint64_t anew = 0;
  EXPECT_EQ(UpdatedSurface(session.get(), anew, {}), cut);
  EXPECT_EQ(anew, generation);

  OsteonSurfaceInfo info;
  const std::string file = TemporaryPath("block.stl").string();
  ASSERT_OK(osteon_session_surface_export(session.get(), file.c_str(), &info));
  EXPECT_EQ(info.triangles, Triangles(cut));
  EXPECT_EQ(info.watertight, 1U);
  EXPECT_EQ(osteon_session_surface_export(session.get(), "block.txt", nullptr), OSTEON_ERROR_ARGUMENT);
  OsteonSurfaceBuffers none{};
  EXPECT_EQ(osteon_session_surface_changes(session.get(), &anew, &none), OSTEON_ERROR_ARGUMENT);
}

TEST(OsteonSession, UndoBringsBoneAndSurfaceBack) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep());
  FeedTo(session.get(), 3.2);
  std::uint64_t generation = 0;
  const auto marked = UpdatedSurface(session.get(), generation, {});
  const double marked_m3 = FiguresOf(session.get()).removed_volume_m3;
  ASSERT_OK(osteon_session_mark(session.get()));
  FeedTo(session.get(), 1.5, 3.2);
  const auto now = UpdatedSurface(session.get(), generation, marked);
  EXPECT_NE(now, marked);
  EXPECT_GT(FiguresOf(session.get()).removed_volume_m3, marked_m3);

  const OsteonPose deep = Above(1.5), free = Above(4.2);
  EXPECT_EQ(osteon_session_undo(session.get(), &deep), OSTEON_ERROR_STATE)
      << "bone would come back into the tool";
  EXPECT_NE(std::string(osteon_last_error()).find("move the tool out"), std::string::npos);
  EXPECT_EQ(UpdatedSurface(session.get(), generation, now), now) << "nothing has changed";
  ASSERT_OK(osteon_session_undo(session.get(), &free));
  EXPECT_EQ(FiguresOf(session.get()).removed_volume_m3, marked_m3);
  EXPECT_EQ(UpdatedSurface(session.get(), generation, now), marked);
  EXPECT_EQ(osteon_session_undo(session.get(), &free), OSTEON_ERROR_STATE) << "no mark is left";

  // the force fades in again
  OsteonWrench wrench;
  const OsteonPose below = Above(3.0);
  ASSERT_OK(osteon_session_step(session.get(), &below, 0.0, 0.001));
  ASSERT_OK(osteon_session_evaluate(session.get(), &below, nullptr, &wrench));
  EXPECT_LT(ForceOf(wrench), 2.0);
}

TEST(OsteonSession, RestoresASavedBoneAndItsSurface) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const std::string file = TemporaryPath("cut.state").string();
  std::map<std::uint32_t, std::vector<std::uint32_t>> saved;
  double removed_m3 = 0.0;
  {
    const auto session = MakeSession(bone.get(), tool.get(), Lockstep());
    FeedTo(session.get(), 2.5);
    ASSERT_OK(osteon_session_save(session.get(), file.c_str()));
    removed_m3 = FiguresOf(session.get()).removed_volume_m3;
    std::uint64_t generation = 0;
    saved = UpdatedSurface(session.get(), generation, {});
  }
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep());
  const OsteonPose free = Above(4.2), inside = Above(0.0);
  EXPECT_EQ(osteon_session_restore(session.get(), file.c_str(), &inside), OSTEON_ERROR_STATE);
  ASSERT_OK(osteon_session_restore(session.get(), file.c_str(), &free));
  EXPECT_EQ(FiguresOf(session.get()).removed_volume_m3, removed_m3);
  std::uint64_t generation = 0;
  EXPECT_EQ(UpdatedSurface(session.get(), generation, {}), saved);
  EXPECT_EQ(osteon_session_restore(session.get(), "no_such.state", &free), OSTEON_ERROR_FILE);
  EXPECT_EQ(osteon_session_save(session.get(), "no_such_folder/cut.state"), OSTEON_ERROR_FILE);
}

TEST(OsteonSession, ChangesToolsInOneBone) {
  const auto bone = BlockOfBalls();
  const auto small = BallTool(2.0F), large = BallTool(3.0F);
  const auto session = MakeSession(bone.get(), small.get(), Lockstep());
  FeedTo(session.get(), 2.0, 3.2);
  const double by_small_m3 = FiguresOf(session.get()).removed_volume_m3;
  ASSERT_GT(by_small_m3, 0.0);
  const OsteonPose deep = Above(2.0), free = Above(4.2);
  EXPECT_EQ(osteon_session_change_tool(session.get(), large.get(), &deep), OSTEON_ERROR_STATE);
  ASSERT_OK(osteon_session_change_tool(session.get(), large.get(), &free));
  EXPECT_EQ(FiguresOf(session.get()).removed_volume_m3, by_small_m3);
  FeedTo(session.get(), 3.0);
  EXPECT_GT(FiguresOf(session.get()).removed_volume_m3, by_small_m3);
}

TEST(OsteonSession, ReportsEachEventOnce) {
  OsteonBoneParams params;
  osteon_bone_params_default(&params);
  params.scene = "molar";
  params.config_folder = ConfigFolder().c_str();
  OsteonBone* made = nullptr;
  ASSERT_OK(osteon_bone_create(OSTEON_ABI, &params, &made));
  const Owned<OsteonBone> bone(made);
  const auto tool = BallTool(1.5F);
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep(false));
  std::vector<std::string> names;
  for (double z_mm = 3.0; z_mm > -12.0; z_mm -= 0.004) {
    OsteonPose pose;
    ASSERT_OK(osteon_bone_approach(bone.get(), 1e-3 * z_mm, &pose));
    ASSERT_OK(osteon_session_step(session.get(), &pose, 500.0, 0.002));
    OsteonEvent event;
    while (osteon_session_next_event(session.get(), &event) == OSTEON_OK) names.emplace_back(event.name);
  }
  EXPECT_EQ(std::count(names.begin(), names.end(), "pulp reached"), 1) << names.size();
}

TEST(OsteonSession, RefusesCallsOfAnotherMode) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep(false));
  const OsteonPose free = Above(4.2);
  EXPECT_EQ(osteon_session_set_tool_pose(session.get(), &free, 0.0), OSTEON_ERROR_STATE);
  EXPECT_EQ(osteon_session_step(session.get(), &free, 0.0, 0.2), OSTEON_ERROR_ARGUMENT);
  EXPECT_EQ(osteon_session_surface_wait(session.get()), OSTEON_ERROR_STATE) << "it has no surface";
  std::uint64_t generation = 0;
  OsteonSurfaceBuffers buffers{};
  EXPECT_EQ(osteon_session_surface_changes(session.get(), &generation, &buffers), OSTEON_ERROR_STATE);
}

TEST(OsteonSession, RefusesAForkedChild) {
  const auto bone = BlockOfBalls();
  const auto tool = BallTool();
  const auto session = MakeSession(bone.get(), tool.get(), Lockstep(false));
  const pid_t child = fork();
  if (child == 0) {
    OsteonFigures figures;
    const OsteonPose free = Above(4.2);
    OsteonWrench wrench;
    const bool refused =
        osteon_session_figures(session.get(), &figures) == OSTEON_ERROR_FORK &&
        osteon_session_evaluate(session.get(), &free, nullptr, &wrench) == OSTEON_ERROR_FORK &&
        osteon_session_step(session.get(), &free, 0.0, 0.001) == OSTEON_ERROR_FORK;
    _exit(refused ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

}  // namespace
}  // namespace osteon::plugin
