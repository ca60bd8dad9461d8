#include <cstdlib>
#include <optional>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "session/run/cell_run.h"
#include "session/setup/cell_setup.h"
#include "simulation/solids/cup_frame.h"
#include "tests/io/temporary_folder.h"
#include "tests/session/set_up_cell.h"

// Runs of every shipped cell, and of a mesh from the data set in suitable cells.

namespace osteon::session {
namespace {

namespace fs = std::filesystem;

const fs::path kCells = OSTEON_SOURCE_DIR "/config/cells";

/// Runs a cell in virtual time and expects no fault and no use of the last safeguards. @returns nothing if it
/// could not run
std::optional<CellRunResult> RunScene(const CellSetup& setup, const std::string& engine_name,
                                      double seconds) {
  const io::test::TemporaryFolder folder;
  auto engine = MakeEngine(setup, {.engine = engine_name});
  if (!engine) {
    ADD_FAILURE() << engine.error();
    return std::nullopt;
  }
  auto result = RunCell(setup, **engine,
                        {.seconds = seconds, .virtual_time = true, .recording = folder.path() / "r.mcap"});
  if (!result) {
    ADD_FAILURE() << result.error().what;
    return std::nullopt;
  }
  EXPECT_EQ(result->end, control::RunEnd::kSeconds);
  EXPECT_EQ(result->faults.bits(), 0u);
  EXPECT_GE(result->statistics.active_ticks,
            static_cast<std::uint64_t>(seconds / setup.config.servo.period_s));
  EXPECT_LE(result->statistics.peak_coupling_force_N, setup.config.servo.wrench.max_force_N);
  // the last safeguards are never needed
  EXPECT_EQ(result->statistics.limits.Of(safety::Limit::kPassivity).events, 0u);
  EXPECT_EQ(result->statistics.limits.Of(safety::Limit::kTank).events, 0u);
  EXPECT_GT(result->statistics.min_tank_J, 0.0);
  return std::move(*result);
}
/// Runs 0.3 s on the CPU engine, which gives the reference engine's bits in a tenth of its time.
void ExpectToRun(const CellSetup& setup) { static_cast<void>(RunScene(setup, "cpu", 0.3)); }

/// Checks that the bone has the scene's materials, that its balls (3000 to 40 000) lie in its solid, and that
/// the site's axis leads from outside into the bone.
void ExpectPackedAsTheSceneSays(const CellSetup& setup) {
  const simulation::Bone& bone = setup.bone;
  EXPECT_GT(bone.balls.size(), 3'000u);
  EXPECT_LT(bone.balls.size(), 40'000u);
  EXPECT_GT(bone.points.size(), 5'000u);
  EXPECT_LT(bone.points.size(), 120'000u);
  std::vector<double> volume_m3(bone.materials.size());
  for (const simulation::MassPoint& point : bone.points) volume_m3.at(point.material) += point.volume_m3;
  for (std::size_t i = 0; i < volume_m3.size(); ++i) {
    const std::string& name = bone.materials[i].name;
    const bool worn_off =  // the femoral head's scene says 0 mm
        name == "cartilage" && std::holds_alternative<simulation::FemoralHeadShape>(setup.config.scene.shape);
    EXPECT_EQ(volume_m3[i] > 0.0, !worn_off) << name;
  }
  for (std::size_t i = 0; i < bone.balls.size(); i += 7) {
    const double outside_m = bone.balls[i].radius_m + setup.solid->SignedDistance(bone.balls[i].center_m);
    ASSERT_LE(outside_m, 1e-9) << "ball " << i << " leaves the solid";
  }
  const Vector3 site = bone.site.center_m, axis = bone.site.axis;
  EXPECT_GT(setup.solid->SignedDistance(site + 1e-3 * axis), 0.0);
  EXPECT_LT(setup.solid->SignedDistance(site - 1.05 * bone.site.radius_m * axis), 1.1e-3);
}

TEST(SceneCells, EachIsPackedAsItsSceneSaysAndRunsWithoutAFault) {
  int cells = 0;
  for (const auto& entry : fs::directory_iterator(kCells)) {
    SCOPED_TRACE(entry.path().filename());
    const auto setup = SetUpCell(entry.path(), std::nullopt);
    ASSERT_TRUE(setup) << setup.error();
    ExpectPackedAsTheSceneSays(*setup);
    // the tool points at the site along its axis, from outside the bone
    const Pose X_WC = setup->X_WG * simulation::CupPose(setup->bone.site);
    const Pose& X_WT = setup->config.start.X_WT;
    EXPECT_NEAR(X_WT.linear().col(2).dot(X_WC.linear().col(2)), -1.0, 1e-9);
    const Vector3 p_CT = X_WC.inverse() * X_WT.translation();
    EXPECT_LT(p_CT.head<2>().norm(), 1e-6);
    for (const simulation::ToolBall& ball : setup->config.tool.tool.balls) {
      const Vector3 c = setup->X_WG.inverse() * (X_WT * Vector3(ball.center_m));
      ASSERT_GT(setup->solid->SignedDistance(c), ball.radius_m) << "the tool begins in the bone";
    }
    ExpectToRun(*setup);
    ++cells;
  }
  EXPECT_GE(cells, 6);
}

class WholeScript : public ::testing::TestWithParam<const char*> {};

// Runs a cell's script from approach to retraction with the arm's level kServo (lag) and kDynamic (masses,
// friction, wrong masses in the controller, a compliant mounting). Neither run may fault. A hand would notice
// a difference of more than 7 %. Force or removal must differ by more than that in the cells whose file asks
// for the level kDynamic, and in no others.
TEST_P(WholeScript, DiffersBetweenTheArmsLevelsOnlyIfTheCellAsksForMasses) {
  auto setup = SetUpCell(kCells / (std::string(GetParam()) + ".yaml"), std::nullopt);
  ASSERT_TRUE(setup) << setup.error();
  hil::SimulatedCellParams& cell = setup->config.simulated;
  const bool needs_masses = cell.level == hil::ArmLevel::kDynamic;
  cell.level = hil::ArmLevel::kServo;
  const auto servo = RunScene(*setup, "cpu", 10.0);

  const config::CellConfig demo = config::LoadCell(kCells / "demo.yaml");
  ASSERT_TRUE(demo.simulated.dynamic.mount);
  cell.level = hil::ArmLevel::kDynamic;
  cell.dynamic = demo.simulated.dynamic;
  for (std::size_t i = 0; i < 7; ++i) cell.chain.joints[i].friction = demo.simulated.chain.joints[i].friction;
  const auto dynamic = RunScene(*setup, "cpu", 10.0);
  ASSERT_TRUE(servo && dynamic);
  const double force =
      dynamic->statistics.peak_coupling_force_N / servo->statistics.peak_coupling_force_N - 1.0;
  const double volume = dynamic->after.removed_volume_m3 / servo->after.removed_volume_m3 - 1.0;
  RecordProperty("force_change", std::to_string(force));
  RecordProperty("volume_change", std::to_string(volume));
  EXPECT_NE(force, 0.0) << "the level acts";
  EXPECT_EQ(std::max(std::abs(force), std::abs(volume)) > 0.07, needs_masses) << force << " " << volume;
}

INSTANTIATE_TEST_SUITE_P(SceneCells, WholeScript,
                         ::testing::Values("demo", "molar", "femoral_canal", "thin_plate", "sawbone_block"),
                         [](const auto& param) { return std::string(param.param); });

// A tooth from the data set as the bone; skipped without the data.
class DataMeshes : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("OSTEON_DATA_DIR");
    tooth_.file = fs::path(data ? data : "") / "tooth_molar_with_pulp.obj";
    if (!data || !fs::exists(tooth_.file)) GTEST_SKIP() << "skipped, no anatomical meshes";
  }
  MeshChoice tooth_{.file = {},
                    .cup = simulation::CutSite{.center_m = Vector3(0, 0.0005, 0.0080),
                                               .axis = Vector3(0, 0, 1),
                                               .radius_m = 0.00175},
                    .scale = 0.041};
};

TEST_F(DataMeshes, TheToothRunsInTheMolarsCellAndHasPulp) {
  const auto setup = SetUpCell(kCells / "molar.yaml", tooth_);
  ASSERT_TRUE(setup) << setup.error();
  EXPECT_LT(setup->bone.balls.size(), 40'000u);
  std::vector<double> volume_mm3(setup->bone.materials.size());
  for (const simulation::MassPoint& point : setup->bone.points)
    volume_mm3.at(point.material) += point.volume_m3 * 1e9;
  ASSERT_EQ(setup->bone.materials[2].name, "pulp");
  EXPECT_GT(volume_mm3[2], 20.0);
  EXPECT_GT(volume_mm3[1], volume_mm3[2]);
  ExpectToRun(*setup);
}

TEST_F(DataMeshes, TheDemosCellAcceptsTheToothWithACupOnIt) {
  const auto setup = SetUpCell(kCells / "demo.yaml", tooth_);
  ASSERT_TRUE(setup) << setup.error();
  EXPECT_GT(setup->bone.balls.size(), 100u);
}

}  // namespace
}  // namespace osteon::session
