#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include "config/reading/sections/compliance_params.h"
#include "tests/session/run/virtual_run.h"

// Runs of shipped cells with compliance (a bending tool, a surface layer, a soft mount) in virtual time. The
// engines must agree as well as without compliance. If the planner leaves a part rigid, its compliance must
// hardly change the result.

namespace osteon::session {
namespace {

// Mean coupling force [N] over the ticks in contact, which are those with more than 1 N.
double MeanForce(const VirtualRun& finished) {
  double sum_N = 0.0;
  int count = 0;
  for (const control::TickRecord& tick : finished.recording.ticks) {
    const double force_N = Vector3(tick.F_coupling_T_W.f).norm();
    if (!(force_N > 1.0)) continue;
    sum_N += force_N;
    ++count;
  }
  return count == 0 ? 0.0 : sum_N / count;
}

// Expects equal commands and displacements in all ticks, to the last bit.
void ExpectSameTicks(const VirtualRun& a, const VirtualRun& b) {
  ASSERT_EQ(a.recording.ticks.size(), b.recording.ticks.size());
  for (std::size_t i = 0; i < a.recording.ticks.size(); ++i) {
    const control::TickRecord &one = a.recording.ticks[i], &other = b.recording.ticks[i];
    ASSERT_EQ(one.q_cmd, other.q_cmd) << i;
    ASSERT_EQ(one.compliance.X_ME.R, other.compliance.X_ME.R) << i;
    ASSERT_EQ(Vector3(one.compliance.bend_m), Vector3(other.compliance.bend_m)) << i;
    ASSERT_EQ(Vector3(one.compliance.mount_m), Vector3(other.compliance.mount_m)) << i;
    ASSERT_EQ(Vector3(one.compliance.layer_m), Vector3(other.compliance.layer_m)) << i;
  }
}

// Runs a shipped cell in virtual time with a chosen engine, without the cell's report.
VirtualRun RunOn(const EngineChoice& choice, const std::string& name, double seconds,
                 void (*change)(config::CellConfig&)) {
  auto setup = SetUpCell(OSTEON_SOURCE_DIR "/config/cells/" + name + ".yaml", std::nullopt);
  EXPECT_TRUE(setup) << setup.error();
  change(setup->config);
  auto engine = MakeEngine(*setup, choice);
  EXPECT_TRUE(engine) << engine.error();
  const io::test::TemporaryFolder folder;
  const CellRunParams params{.seconds = seconds, .virtual_time = true, .recording = folder.path() / "r.mcap"};
  auto result = RunCell(*setup, **engine, params);
  EXPECT_TRUE(result) << result.error().what;
  auto recording = io::ReadRecording(params.recording);
  EXPECT_TRUE(recording) << recording.error();
  VirtualRun finished;
  finished.summary = Summarise(*setup, **engine, params, *result, AccumulateRun(*setup, *recording));
  finished.recording = std::move(*recording);
  finished.result = std::move(*result);
  return finished;
}

// Sets the bone on a compliant mount, in addition to the cell's bending tool.
void AddMount(config::CellConfig& cell) {
  control::BoneMountParams mount;
  mount.p_WMo_m = cell.X_WG * Vector3(0.0, 0.0, -0.05);
  cell.servo.compliance.mount = mount;
}

TEST(ComplianceEngines, TheReferenceEngineAndTheCpuEngineGiveTheSameRun) {
  const VirtualRun cpu = RunInVirtualTime("long_drill", 0.7, AddMount);
  const VirtualRun reference = RunOn({.engine = "reference"}, "long_drill", 0.7, AddMount);
  ExpectSameTicks(cpu, reference);
  EXPECT_EQ(cpu.summary.state_hash, reference.summary.state_hash);
  EXPECT_GT(MeanForce(cpu), 1.0);
  EXPECT_GT(Vector3(cpu.recording.ticks.back().compliance.mount_m).norm(), 10e-6);
}

// The GPU's engine computes in single precision: the mean force is within 1 %, the removed volume within 2 %.
TEST(ComplianceEngines, TheVulkanEngineIsWithinOnePercentOfForceAndTwoOfRemoval) {
  const auto setup = SetUpCell(OSTEON_SOURCE_DIR "/config/cells/long_drill.yaml", std::nullopt);
  ASSERT_TRUE(setup) << setup.error();
  if (!MakeEngine(*setup, {.engine = "vulkan"})) GTEST_SKIP() << "skipped, no Vulkan device";
  const VirtualRun cpu = RunInVirtualTime("long_drill", 0.7, AddMount);
  const VirtualRun vulkan = RunOn({.engine = "vulkan"}, "long_drill", 0.7, AddMount);
  EXPECT_NEAR(MeanForce(vulkan), MeanForce(cpu), 0.01 * MeanForce(cpu));
  EXPECT_NEAR(vulkan.summary.removed_volume_m3, cpu.summary.removed_volume_m3,
              0.02 * cpu.summary.removed_volume_m3 + 1e-10);
  EXPECT_TRUE(vulkan.summary.faults.empty());
}

// The planner leaves the demo's reamer and its cartilage rigid. If either were compliant, the force would
// change by less than 7 % and the depth by less than the scene's error.
TEST(ComplianceLevels, APartThatThePlannerLeavesRigidWouldHardlyChangeForceAndDepth) {
  constexpr double kSeconds = 4.0;
  double error_m = 0.0;
  const VirtualRun rigid = RunInVirtualTime("demo", kSeconds, [&](config::CellConfig& cell) {
    error_m = cell.compliance.error_m;
    EXPECT_FALSE(cell.servo.compliance.any());
  });
  const auto expect_unnoticed = [&](const char* level, const auto& switch_on) {
    const VirtualRun finer = RunInVirtualTime("demo", kSeconds, switch_on);
    const double force = MeanForce(finer) / MeanForce(rigid) - 1.0,
                 depth_m = finer.summary.reamed_depth_m - rigid.summary.reamed_depth_m;
    std::printf("  %s: force %+.4f, depth %+.4f mm\n", level, force, 1e3 * depth_m);
    EXPECT_NE(force, 0.0) << level << " acts";
    EXPECT_LT(std::abs(force), 0.07) << level;
    EXPECT_LT(std::abs(depth_m), error_m) << level;
  };
  EXPECT_GT(MeanForce(rigid), 10.0);
  EXPECT_GT(rigid.summary.reamed_depth_m, 0.0);
  expect_unnoticed("tool", [](config::CellConfig& cell) {
    const config::ToolBendingConfig& bending = *cell.tool.bending;
    cell.servo.compliance.tool =
        config::ToolLinkOf(bending.compliance, bending.relaxation_s, cell.compliance.push_N);
  });
  expect_unnoticed("layer", [](config::CellConfig& cell) {
    cell.servo.compliance.layer =
        config::SurfaceLayerOf(cell.scene.materials, cell.tool.tool, cell.cutting.engaged_layer_m);
  });
}

// The planner lets the long drill bend. This must matter: the drill bends by more than 0.05 mm, or the force
// differs from that of a rigid drill by more than 7 %.
TEST(ComplianceLevels, APartThatThePlannerMakesCompliantBendsOrChangesTheForce) {
  const VirtualRun bends = RunInVirtualTime(
      "long_drill", 2.5, [](config::CellConfig& cell) { EXPECT_TRUE(cell.servo.compliance.tool) << "auto"; });
  const VirtualRun rigid = RunInVirtualTime(
      "long_drill", 2.5, [](config::CellConfig& cell) { cell.servo.compliance.tool.reset(); });
  double bend_m = 0.0;
  for (const control::TickRecord& tick : bends.recording.ticks)
    bend_m = std::max(bend_m, Vector3(tick.compliance.bend_m).head<2>().norm());
  const double force = MeanForce(bends) / MeanForce(rigid) - 1.0;
  std::printf("  bends by %.4f mm, force %+.4f\n", 1e3 * bend_m, force);
  EXPECT_TRUE(bend_m > 0.05e-3 || std::abs(force) > 0.07);
}

}  // namespace
}  // namespace osteon::session
