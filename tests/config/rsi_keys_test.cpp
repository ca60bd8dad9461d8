#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "config/reading/load.h"
#include "kinematics/ortho_parallel_arm.h"
#include "tests/config/cell_text.h"

// Tests the keys in a cell's section rsi, which configure the link to a six-axis arm and the arm's
// simulation. Also tests combinations that are refused.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

using Edits = std::vector<std::pair<std::string, std::string>>;

class RsiKeys : public testing::Test {
 protected:
  void SetUp() override {
    fs::copy(fs::path(OSTEON_SOURCE_DIR) / "config", folder_, fs::copy_options::recursive);
  }
  void TearDown() override { fs::remove_all(folder_); }
  // Loads a shipped cell after replacing texts of its file, each at its first occurrence.
  CellConfig LoadWith(const Edits& edits, const std::string& name = "kr_16_thin_plate") const {
    std::string edited = CellText(name);
    for (const auto& [before, after] : edits) {
      const std::size_t at = edited.find(before);
      if (at == std::string::npos) throw std::logic_error(name + " has changed: " + before);
      edited.replace(at, before.size(), after);
    }
    const fs::path cell = folder_ / "cells/edited.yaml";
    std::ofstream(cell) << edited;
    return LoadCell(cell);
  }
  // The error of LoadWith for these edits; empty if the cell is accepted.
  std::string Refusal(const Edits& edits, const std::string& name = "kr_16_thin_plate") const {
    try {
      static_cast<void>(LoadWith(edits, name));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }
  const fs::path folder_ =
      fs::temp_directory_path() / ("osteon_rsi_keys_" + std::to_string(::getpid()) + "_" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(RsiKeys, ReachLinkLoopAndSimulatedArm) {
  const CellConfig cell =
      LoadWith({{"layout: im_free\n", "layout: kroshu\n"},
                {"absolute: true\n", "absolute: false\n"},
                {"hold_on: true\n", "hold_on: false\n"},
                {"  cycle_ms: 4\n  ipoc", "  cycle_ms: 12\n  ipoc"},
                {"ipoc_step_count: 4\n", "ipoc_step_count: 1\n"},
                {"timeout_count: 100\n",
                 "timeout_count: 50\n  entry_step_deg: 0.5\n  settle_count: 20\n"
                 "  late_at_start_count: 3\n  decimal_count: 5\n"},
                {"range_deg: [90, 90, 90, 90, 90, 90]", "range_deg: [1, 2, 3, 4, 5, 6]"}});
  ASSERT_NE(cell.link.rsi(), nullptr);
  EXPECT_EQ(cell.link.fri(), nullptr);
  EXPECT_EQ(cell.link.port, 49152);
  const io::RsiSessionParams& session = *cell.link.rsi();
  EXPECT_EQ(session.layout, io::RsiLayout::kKroshu);
  EXPECT_EQ(session.kind, io::RsiCorrection::kAxes);
  EXPECT_FALSE(session.absolute);
  EXPECT_FALSE(session.hold_on);
  EXPECT_EQ(session.cycle_ms, 12);
  EXPECT_EQ(session.ipoc_step, 1);
  EXPECT_EQ(session.timeout_cycles, 50);
  EXPECT_NEAR(session.entry_step_deg, 0.5, 1e-12);
  EXPECT_EQ(session.settle_messages, 20);
  EXPECT_EQ(session.late_at_start, 3);
  EXPECT_EQ(session.decimals, 5);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(session.range[static_cast<std::size_t>(i)], i + 1.0, 1e-12);
  EXPECT_EQ(cell.servo.period_s, 0.012);
  const hil::RsiArmParams& arm = cell.simulated.kr.value();
  EXPECT_EQ(arm.controller.format, hil::RsiFormat::kKroshu);
  EXPECT_FALSE(arm.controller.absolute);
  EXPECT_FALSE(arm.controller.hold_on);
  EXPECT_EQ(arm.controller.cycle_ms, 12);
  EXPECT_EQ(arm.controller.ipoc_step, 1);
  EXPECT_EQ(arm.controller.timeout_cycles, 50);
  EXPECT_EQ(arm.handed_over_answers, 20);
  EXPECT_NEAR(arm.controller.servo.dead_cycles, 2.0 / 3.0, 1e-12) << "8 ms of 12";
  EXPECT_NEAR(arm.controller.range[5], 91.0, 1e-12);
}

TEST_F(RsiKeys, CartesianCorrectionsHaveRangesInMillimetresAndDegrees) {
  const CellConfig cell = LoadWith(
      {{"correction: axes\n", "correction: cartesian\n"},
       {"range_deg: [90, 90, 90, 90, 90, 90]", "range_mm: [100, 110, 120]\n  range_deg: [10, 11, 12]"},
       {"monitor_deg: [91, 91, 91, 91, 91, 91]",
        "monitor_mm: [101, 111, 121]\n  monitor_deg: [13, 14, 15]"}});
  EXPECT_TRUE(cell.simulated.kr->controller.cartesian);
  EXPECT_NEAR(cell.link.rsi()->range[1], 110.0, 1e-9);
  EXPECT_NEAR(cell.link.rsi()->range[5], 12.0, 1e-9);
  EXPECT_NEAR(cell.simulated.kr->controller.range[2], 121.0, 1e-9);
  ASSERT_TRUE(cell.link.rsi()->arm) << "joints become poses by it";
  EXPECT_EQ(cell.link.rsi()->arm->c2_m, 0.68);
  EXPECT_NO_THROW(io::RsiSession(*cell.link.rsi()));
}

TEST_F(RsiKeys, ACellHasOneLink) {
  EXPECT_THAT(Refusal({{"rsi:\n", "fri: {host: 127.0.0.1, port: 30200, period_ms: 1}\nrsi:\n"}}),
              HasSubstr("rsi: found beside fri, accepted one of fri, rsi"));
  const std::string text = CellText("thin_plate");
  const std::size_t from = text.find("fri:\n"), to = text.find("operator:\n");
  EXPECT_THAT(Refusal({{text.substr(from, to - from), ""}}, "thin_plate"),
              HasSubstr("missing key \"fri\", accepted one of fri, rsi"));
}

TEST_F(RsiKeys, RobotAndLinkGoTogether) {
  EXPECT_THAT(Refusal({{"/robots/kr_16_2.yaml", "/robots/lbr_iiwa_14_r820.yaml"}}),
              AllOf(HasSubstr(": robot: found LBR iiwa 14 R820 with 7 joints"),
                    HasSubstr("an arm of six axes, which rsi drives; an LBR needs fri")));
  EXPECT_THAT(Refusal({{"/robots/lbr_iiwa_14_r820.yaml", "/robots/kr_16_2.yaml"}}, "thin_plate"),
              AllOf(HasSubstr(": robot: found KR 16-2 with 6 joints"),
                    HasSubstr("an LBR, which fri drives; an arm of six axes needs rsi")));
}

TEST_F(RsiKeys, KeysThatOnlyAnLbrHasAreUnknown) {
  EXPECT_THAT(Refusal({{"  height_mm: 15", "  arm_angle_deg: 0\n  height_mm: 15"}}),
              HasSubstr("unknown key \"arm_angle_deg\""));
  EXPECT_THAT(Refusal({{"  joint_acceleration_ratio", "  limit_zone_deg: 20\n  joint_acceleration_ratio"}}),
              HasSubstr("unknown key \"limit_zone_deg\""));
  EXPECT_THAT(Refusal({{"simulated_arm:\n", "link_quality: {fair_answered_count: 10}\nsimulated_arm:\n"}}),
              HasSubstr("unknown key \"link_quality\""));
}

TEST_F(RsiKeys, ValuesThatContradictEachOtherAreRefused) {
  EXPECT_THAT(Refusal({{"  cycle_ms: 4\n  ipoc", "  cycle_ms: 8\n  ipoc"}}),
              HasSubstr("cycle_ms: found 8, accepted 4, 12"));
  EXPECT_THAT(Refusal({{"ipoc_step_count: 4", "ipoc_step_count: 3"}}),
              HasSubstr("ipoc_step_count: found 3, accepted 1, or cycle_ms (4)"));
  EXPECT_THAT(Refusal({{"range_deg: [90, 90,", "range_deg: [90, 95,"}}),
              HasSubstr("range_deg: found 95, accepted at most 91: the simulated arm's monitor"));
  EXPECT_THAT(Refusal({{"level: servo\n", "level: dynamic\n"}}),
              HasSubstr("level: found dynamic, accepted kinematic or servo: no masses and torques of an arm "
                        "of six axes are published"));
  EXPECT_THAT(Refusal({{"position_mm: [1000, 0, 800]", "position_mm: [2000, 0, 800]"}}),
              HasSubstr("from the arm's shoulder to the site, accepted at most"));
}

// If absolute corrections are not held, one lost answer makes the arm jump back to its position at RSI's
// start. Therefore such a cell must accept this explicitly.
TEST_F(RsiKeys, AbsoluteCorrectionsThatAreNotHeldMustBeAcceptedExplicitly) {
  const std::pair<std::string, std::string> not_held{"hold_on: true\n", "hold_on: false\n"};
  const std::pair<std::string, std::string> added{
      "timeout_count: 100\n", "accept_jump_after_lost_answers: false\n  timeout_count: 100\n"};
  EXPECT_THAT(
      Refusal({not_held}),
      AllOf(HasSubstr("hold_on: found false with absolute corrections, accepted true"),
            HasSubstr("jump back to where RSI began"), HasSubstr("accept_jump_after_lost_answers: true")));
  EXPECT_THAT(Refusal({not_held, added}), HasSubstr("hold_on: found false with absolute corrections"));
  EXPECT_EQ(Refusal({not_held, {"absolute: true\n", "absolute: false\n"}}), "") << "relative ones only rest";
  const CellConfig cell =
      LoadWith({not_held, {added.first, "accept_jump_after_lost_answers: true\n  timeout_count: 100\n"}});
  EXPECT_FALSE(cell.link.rsi()->hold_on);
  EXPECT_FALSE(cell.simulated.kr->controller.hold_on);
}

TEST_F(RsiKeys, TheArmStartsInItsUsualPostureWithTheToolAtTheSite) {
  const CellConfig cell = LoadWith({});
  const kinematics::OrthoParallelArm arm(cell.robot.six_axis()->params);
  const kinematics::JointVectorN<6> q = cell.start.q.head<6>();
  EXPECT_EQ(cell.start.q[6], 0.0);
  const Pose X_WT = cell.X_WB * arm.FlangePose(q) * cell.tool.X_FT;
  EXPECT_LT((X_WT.matrix() - cell.start.X_WT.matrix()).cwiseAbs().maxCoeff(), 1e-12);
  const double degree = 0.017453292519943295;
  const kinematics::JointVectorN<6> usual =
      degree * (kinematics::JointVectorN<6>() << 0, -90, 90, 0, 90, 0).finished();
  EXPECT_EQ(arm.Configuration(q), arm.Configuration(usual)) << "elbow up, wrist not flipped, in front";
  EXPECT_LT((q - usual).cwiseAbs().maxCoeff(), 60.0 * degree);
}

TEST_F(RsiKeys, AnArmThatIsTooShortIsRefusedAtItsStart) {
  EXPECT_THAT(Refusal({{"/robots/kr_16_2.yaml", "/robots/kr_6_r900_2.yaml"}}),
              HasSubstr("out of the stretched arm's reach; base_in_world says where the arm stands"));
}

}  // namespace
}  // namespace osteon::config
