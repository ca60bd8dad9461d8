#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/reading/config_file_tracker.h"
#include "config/reading/load.h"
#include "tests/io/temporary_folder.h"

// Tests the keys that place a cell's own bone, the keys for bounds in the bone's frame, and a cell without a
// simulation.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class BoneKeys : public testing::Test {
 protected:
  BoneKeys() { SetShippedFolder(fs::path(OSTEON_SOURCE_DIR) / "config"); }
  // Loads a cell of this text.
  CellConfig Load(const std::string& text) const {
    io::test::WriteAll(folder_.path() / "my.yaml", text);
    return LoadCell(folder_.path() / "my.yaml");
  }
  // The error of loading a cell of this text; empty if it is accepted.
  std::string Refusal(const std::string& text) const {
    try {
      static_cast<void>(Load(text));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }
  io::test::TemporaryFolder folder_;
};

constexpr const char* kCup = "cup: {center_mm: [8.8, -131.9, 517.9], outward_axis: [0, 0, 1], radius_mm: 21}";

TEST_F(BoneKeys, AMeshIsFoundFromTheCellsFolderAndHasItsCup) {
  io::test::WriteAll(folder_.path() / "hip.obj", "");
  const CellConfig cell =
      Load(std::string("extends: demo\nbone:\n  mesh: hip.obj\n  scale_ratio: 2\n  ") + kCup + "\n");
  ASSERT_TRUE(cell.bone);
  EXPECT_EQ(cell.bone->file, folder_.path() / "hip.obj");
  EXPECT_EQ(cell.bone->scale, 2.0);
  ASSERT_TRUE(cell.bone->cup);
  EXPECT_DOUBLE_EQ(cell.bone->cup->radius_m, 0.021);
  EXPECT_DOUBLE_EQ(Vector3(cell.bone->cup->center_m).y(), -0.1319);
  EXPECT_FALSE(Load("extends: demo\n").bone);
}

TEST_F(BoneKeys, APackingMayHaveItsOwnSiteAndAMeshMayNot) {
  io::test::WriteAll(folder_.path() / "hip.osp", "");
  io::test::WriteAll(folder_.path() / "hip.obj", "");
  EXPECT_FALSE(Load("extends: demo\nbone: {packing: hip.osp}\n").bone->cup);
  EXPECT_THAT(Refusal("extends: demo\nbone: {mesh: hip.obj}\n"),
              HasSubstr("my.yaml:2: mesh: found no cup beside it, accepted cup: {center_mm"));
  EXPECT_THAT(Refusal("extends: demo\nbone: {mesh: hip.obj, packing: hip.osp}\n"),
              HasSubstr("packing: found beside mesh, accepted one of the two"));
  EXPECT_THAT(Refusal(std::string("extends: demo\nbone: {mesh: none.obj, ") + kCup + "}\n"),
              HasSubstr("my.yaml:2: mesh: found none.obj, accepted an existing file"));
}

TEST_F(BoneKeys, TheBoneMayBeAScene) {
  const CellConfig cell = Load("extends: demo\nbone: {scene: acetabulum_density}\n");
  EXPECT_FALSE(cell.bone);
  EXPECT_TRUE(cell.scene.mesh_tissue.solid.image);
}

// The demo's bounds are given in the bone's frame. They must equal the bounds given in the world, and must
// move with the bone.
TEST_F(BoneKeys, BoundsInTheBonesFrameMoveWithTheBone) {
  const std::string bounds =
      "workspace: {frame: bone, sphere_center_mm: [0, 0, 50], sphere_radius_mm: 150, plane_normal_axis: [0, "
      "0, 1], plane_offset_mm: -70}\n"
      "zones: [{frame: bone, point: flange, keep: out, shape: box, at_mm: [0, 0, -140], edges_mm: [700, 700, "
      "140]}]\n"
      "depth_limit: {frame: bone, at_mm: [0, 0, -38]}\n";
  const CellConfig demo = Load("extends: demo\n"), same = Load("extends: demo\n" + bounds);
  const auto& in_world = demo.servo.workspace;
  const auto& in_bone = same.servo.workspace;
  EXPECT_LT((Vector3(in_world.sphere_center_W_m) - Vector3(in_bone.sphere_center_W_m)).norm(), 1e-12);
  EXPECT_NEAR(in_world.plane_offset_m, in_bone.plane_offset_m, 1e-12);
  EXPECT_LT((Vector3(in_world.zones[0].p_W_m) - Vector3(in_bone.zones[0].p_W_m)).norm(), 1e-12);
  EXPECT_LT((Vector3(demo.servo.depth.bound.p_W_m) - Vector3(same.servo.depth.bound.p_W_m)).norm(), 1e-12);

  const CellConfig moved =
      Load("extends: demo\nbone_in_world: {position_mm: [600, 50, 230], rpy_deg: [0, 0, 90]}\n" + bounds);
  EXPECT_LT((Vector3(moved.servo.workspace.sphere_center_W_m) - Vector3(0.6, 0.05, 0.28)).norm(), 1e-12);
  EXPECT_NEAR(moved.servo.workspace.plane_offset_m, 0.16, 1e-12);
  EXPECT_LT((Vector3(moved.servo.depth.bound.p_W_m) - Vector3(0.6, 0.05, 0.192)).norm(), 1e-12);
  EXPECT_LT((Matrix3(moved.servo.workspace.zones[0].R_W) - moved.X_WG.linear()).norm(), 1e-12);
}

TEST_F(BoneKeys, ARealCellNeedsNoSimulation) {
  const std::string real =
      "extends: demo\nremove: [operator, script, simulated_arm, link_quality, force_sensor.simulated]\n";
  const CellConfig cell = Load(real);
  EXPECT_FALSE(cell.has_simulation);
  EXPECT_THROW(RequireSimulation(cell, "my.yaml"), ConfigError);
  const CellConfig demo = Load("extends: demo\n");
  EXPECT_NO_THROW(RequireSimulation(demo, "my.yaml"));
  EXPECT_EQ(cell.servo.wrench.max_force_N, demo.servo.wrench.max_force_N);
  EXPECT_EQ(cell.start.q, demo.start.q);
  EXPECT_THAT(Refusal("extends: demo\nremove: [script]\n"), HasSubstr("missing key \"script\""));
}

}  // namespace
}  // namespace osteon::config
