#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/app/command.h"

// The demo on a scanned hip bone, if the anatomical meshes are installed (OSTEON_DATA_DIR).

namespace osteon::app {
namespace {

TEST(MeshDemo, ReamsTheHipBone) {
  const char* data = std::getenv("OSTEON_DATA_DIR");
  const std::filesystem::path mesh =
      std::filesystem::absolute(std::filesystem::path(data ? data : "") / "hip_bone_left.obj");
  if (!data || !std::filesystem::exists(mesh)) GTEST_SKIP() << "skipped, no anatomical meshes";
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"demo", "--virtual-time", "--seconds", "3", "--mesh", mesh.string(), "--cup",
                                 "8.8,-131.9,517.9,-0.983,-0.175,0.052,21"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("hip_bone_left"), std::string::npos) << run.out;
  const nlohmann::json summary = ReadJson(folder.path() / "demo_out/summary.json");
  EXPECT_TRUE(summary.at("faults").empty()) << summary.at("faults");
  const double removed_mm3 = summary.at("removed_volume_mm3"), swept_mm3 = summary.at("swept_volume_mm3");
  EXPECT_GT(removed_mm3, 100.0);
  // a tolerance of 10 %: the packing's surface may be rough by 0.08 mm over the cup, which is a large part of
  // such a shallow cut
  EXPECT_NEAR(removed_mm3, swept_mm3, 0.1 * swept_mm3);
  EXPECT_GT(summary.at("removed_mass_g").get<double>(), 0.0);
  EXPECT_TRUE(summary.at("cup_depth_mm").is_number());
  EXPECT_GT(ReadComplete(folder.path() / "demo_out/recording.mcap").ticks.size(), 3000u);

  // the recording does not contain the mesh. Without the mesh a report fails; with the mesh it finds the same
  // bone
  const CommandResult without = RunCommand(folder.path(), {"report", "demo_out/recording.mcap"});
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_NE(without.err.find("accepted with --mesh and --cup"), std::string::npos) << without.err;
  const CommandResult with =
      RunCommand(folder.path(), {"report", "demo_out/recording.mcap", "--json", "again.json", "--mesh",
                                 mesh.string(), "--cup", "8.8,-131.9,517.9,-0.983,-0.175,0.052,21"});
  ASSERT_EQ(with.exit_code, 0) << with.err;
  EXPECT_EQ(ReadJson(folder.path() / "again.json").at("state_hash"), summary.at("state_hash"));
}

}  // namespace
}  // namespace osteon::app
