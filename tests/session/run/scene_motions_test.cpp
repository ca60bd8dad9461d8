#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "gpu/engine/vulkan_engine.h"
#include "session/setup/cell_setup.h"
#include "simulation/tools/motion_player.h"
#include "tests/session/set_up_cell.h"

// Plays each motion under config/motions/ on its own scene.

namespace osteon::session {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> MotionNames() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(fs::path(OSTEON_SOURCE_DIR) / "config/motions"))
    if (entry.path().extension() == ".csv") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class SceneMotion : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(, SceneMotion, testing::ValuesIn(MotionNames()),
                         [](const auto& motion) { return motion.param; });

TEST_P(SceneMotion, CutsItsSceneWithoutAFault) {
  const fs::path file = fs::path(OSTEON_SOURCE_DIR) / "config/motions" / (GetParam() + ".csv");
  const auto motion = simulation::LoadMotion(file);
  ASSERT_TRUE(motion) << motion.error();
  EXPECT_LE(fs::file_size(file), 150'000u);
  EXPECT_GE(motion->samples.back().time_s, 6.0);
  EXPECT_LE(motion->samples.back().time_s, 10.5);

  const auto setup = SetUpCell(fs::path(OSTEON_SOURCE_DIR) / motion->origin.cell, {});
  ASSERT_TRUE(setup) << setup.error();
  EXPECT_EQ(setup->config.tool.tool.name, motion->origin.tool) << "made with another tool: make it again";
  EXPECT_EQ(setup->bone.name, motion->origin.scene) << "made with another scene: make it again";
  auto engine = gpu::VulkanEngine::Create(setup->bone, setup->config.tool.tool, Pose::Identity(),
                                          setup->config.cutting, {});
  ASSERT_TRUE(engine) << engine.error();
  // a quarter of the recording's rate, to save time; a frame cuts at most what the spindle can cut in its
  // duration
  const simulation::MotionPlayer player(*motion, 250.0);
  simulation::ContactModel last;
  double max_N = 0.0;
  for (std::size_t k = 0; k < player.frame_count(); ++k) {
    last = (*engine)->Step(player.Frame(k));
    ASSERT_EQ(last.status, simulation::EngineStatus::kOk) << "frame " << k;
    max_N = std::max(max_N, Vector3(last.F_T_W.f).norm());
  }
  EXPECT_GT(last.removed_volume_m3, 1e-9);
  EXPECT_GT(last.removed_mass_kg, 0.0);
  EXPECT_GT(max_N, 0.5);
  // the motion ends as it began, out of the bone
  EXPECT_EQ(Vector3(last.F_T_W.f).norm(), 0.0);
  std::printf("[ MEASURED ] %s: %zu frames, %.1f mm^3, at most %.1f N\n", GetParam().c_str(),
              player.frame_count(), last.removed_volume_m3 * 1e9, max_N);
}

TEST(SceneMotions, ExistForTheSceneOfEveryCell) {
  const auto motions = MotionNames();
  for (const auto& entry : fs::directory_iterator(fs::path(OSTEON_SOURCE_DIR) / "config/cells")) {
    std::stringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    const std::string cell = text.str(), key = "\nscene: ";
    const std::size_t from = cell.find(key) + key.size();
    const std::string name = cell.substr(from, cell.find('\n', from) - from);
    EXPECT_TRUE(std::ranges::binary_search(motions, name)) << "no config/motions/" << name << ".csv";
  }
}

}  // namespace
}  // namespace osteon::session
