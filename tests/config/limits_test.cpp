#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/config/cell_text.h"

// Tests a cell's limits: the section limits, the zones and the depth limit.

namespace osteon::config {
namespace {

using safety::ZonePoint;
using safety::ZoneShape;
using safety::ZoneSide;
using ::testing::HasSubstr;

TEST(Limits, AreReadAndScaledToTheTool) {
  const CellConfig cell = LoadText(CellText("demo"));
  const control::ServoParams& servo = cell.servo;
  EXPECT_EQ(servo.max_elbow_speed_m_per_s, 0.25);
  EXPECT_EQ(servo.energy.max_power_W, 25.0);
  EXPECT_EQ(servo.energy.moving_mass_kg, 15.0);
  EXPECT_NEAR(servo.spindle_limits.max_torque_Nm, 1.2 * 0.5 * 20.0, 1e-12) << "motor and gear of the tool";
  EXPECT_NEAR(servo.spindle_limits.max_speed_rad_per_s, 1.2 * cell.tool.spindle_rad_per_s, 1e-12);
  ASSERT_EQ(servo.workspace.zones.size(), 2u);
  EXPECT_EQ(servo.workspace.zones[0].shape, ZoneShape::kBox);
  EXPECT_EQ(servo.workspace.zones[0].side, ZoneSide::kKeepOut);
  EXPECT_EQ(servo.workspace.zones[1].point, ZonePoint::kElbow);
  EXPECT_TRUE(servo.depth.acts);
  EXPECT_EQ(servo.depth.soft_m, 4e-3);
}

// `drive: lost_ms` limits the status's age both in the drive's client and in the loop.
TEST(Limits, ALostDriveIsThatOfClientAndLoop) {
  const CellConfig cell = LoadText(With(CellText("demo"), "lost_ms: 100", "lost_ms: 400"));
  EXPECT_DOUBLE_EQ(cell.servo.watchdog.spindle_stop_s, 0.4);
  EXPECT_EQ(cell.devices.drive->missed_cycles * cell.devices.drive->cycle, 400 * rt::kMillisecond);
  EXPECT_EQ(LoadText(CellText("demo")).servo.watchdog.spindle_stop_s, 0.1);
}

// `drive: heartbeat_ms` is the period of both sides' heartbeats, in whole milliseconds as the drive counts.
TEST(Limits, ADrivesHeartbeatIsThatOfItsCell) {
  const auto with = [](const std::string& value) {
    return With(CellText("demo"), "lost_ms: 100", "heartbeat_ms: " + value + "\n  lost_ms: 100");
  };
  EXPECT_EQ(LoadText(CellText("demo")).devices.drive->heartbeat, 50 * rt::kMillisecond);
  EXPECT_EQ(LoadText(with("100")).devices.drive->heartbeat, 100 * rt::kMillisecond);
  EXPECT_THAT(Refusal(with("12.5")), HasSubstr("heartbeat_ms: found 12.5, accepted whole milliseconds"));
  EXPECT_THAT(Refusal(with("101")), AllOf(HasSubstr("heartbeat_ms"), HasSubstr("found 101")));
}

TEST(Limits, AreUnlimitedWhereACellDoesNotNameThem) {
  std::string text = CellText("demo");
  // removes the text between `from` (included) and `to` (not included)
  const auto cut = [&](const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    text.erase(at, text.find(to, at) - at);
  };
  cut("  max_elbow_speed_mm_per_s:", "\n# The joints, while");
  cut("# Convex sets", "# Beyond these ages");
  const control::ServoParams servo = LoadText(text).servo;
  EXPECT_TRUE(std::isinf(servo.max_elbow_speed_m_per_s));
  EXPECT_TRUE(std::isinf(servo.energy.max_stored_J) && std::isinf(servo.energy.max_kinetic_J));
  EXPECT_TRUE(std::isinf(servo.spindle_limits.max_torque_Nm));
  EXPECT_TRUE(servo.workspace.zones.empty());
  EXPECT_FALSE(servo.depth.acts);
}

TEST(Limits, ZonesOfEveryShapeAreRead) {
  const std::string zones = R"(zones:
  - {point: apex, keep: in, shape: sphere, at_mm: [620, 0, 260], radius_mm: 300}
  - {point: flange, keep: out, shape: cylinder, at_mm: [0, 900, 0], along_axis: [0, 0, 1], radius_mm: 50, length_mm: 400}
  - {point: elbow, keep: in, shape: capsule, at_mm: [300, 0, 700], along_axis: [1, 0, 0], radius_mm: 500, length_mm: 600}
  - {point: flange, keep: out, shape: box, at_mm: [0, 900, 0], edges_mm: [10, 20, 30], turn_deg: [0, 0, 90]}
)";
  std::string text = CellText("demo");
  const std::size_t at = text.find("zones:\n");
  text.replace(at, text.find("\n# How deep", at) - at, zones);
  const auto read = LoadText(text).servo.workspace.zones;
  ASSERT_EQ(read.size(), 4u);
  EXPECT_EQ(read[0].radius_m, 0.3);
  EXPECT_EQ(read[1].half_length_m, 0.2);
  EXPECT_NEAR(read[2].R_W.col(2).x(), 1.0, 1e-12);
  EXPECT_NEAR(read[3].R_W.col(0).y(), 1.0, 1e-12);
  EXPECT_EQ(read[3].half_edge_m, Vector3(0.005, 0.01, 0.015));
}

TEST(Limits, ACellChoosesTheReactionAtTheForceLimit) {
  const auto with_limit = [](const std::string& cell, const std::string& line) {
    return With(CellText(cell), "limits:\n", "limits:\n  " + line + "\n");
  };
  const auto reaction = [](const std::string& text) { return LoadText(text).servo.on_force_limit; };
  using safety::OnForceLimit;
  EXPECT_EQ(reaction(With(CellText("demo"), "on_force_limit: slow", "on_force_limit: yield")).reaction,
            OnForceLimit::kYield);
  EXPECT_EQ(reaction(With(CellText("demo"), "on_force_limit: slow", "on_force_limit: stop")).reaction,
            OnForceLimit::kStop);
  // the default of max_tool_in_bone_mm is 2 × 200 N / (20 N/mm) + 3 mm = 23 mm
  EXPECT_EQ(reaction(CellText("demo")).reaction, OnForceLimit::kSlow);
  EXPECT_NEAR(reaction(CellText("demo")).max_tool_in_bone_m, 0.023, 1e-12);
  EXPECT_NEAR(reaction(with_limit("demo", "max_tool_in_bone_mm: 11")).max_tool_in_bone_m, 0.011, 1e-15);
  EXPECT_THAT(Refusal(with_limit("demo", "max_tool_in_bone_mm: 9.9")),
              AllOf(HasSubstr("max_tool_in_bone_mm"), HasSubstr("found 9.9"), HasSubstr("more than 10"),
                    HasSubstr("20 N/mm"), HasSubstr("200 N")));
  EXPECT_EQ(reaction(CellText("thin_plate_impedance")).reaction, OnForceLimit::kYield);
  EXPECT_THAT(
      Refusal(With(CellText("thin_plate_impedance"), "on_force_limit: yield", "on_force_limit: slow")),
      AllOf(HasSubstr("on_force_limit"), HasSubstr("impedance"), HasSubstr("yield or stop")));
  EXPECT_THAT(Refusal(With(CellText("demo"), "on_force_limit: slow", "on_force_limit: never")),
              AllOf(HasSubstr("on_force_limit"), HasSubstr("never"), HasSubstr("yield")));
}

TEST(Limits, ContradictoryValuesAreRefused) {
  const auto refusal_with = [](const std::string& from, const std::string& to) {
    return Refusal(With(CellText("demo"), from, to));
  };
  EXPECT_THAT(refusal_with("spindle_stop_mm: 1", "spindle_stop_mm: 5"),
              HasSubstr("spindle_stop_mm: found 5, accepted at most soft_mm (4)"));
  EXPECT_THAT(refusal_with("stiffness_N_per_mm: 20\n  damping_Ns", "stiffness_N_per_mm: 25\n  damping_Ns"),
              HasSubstr("stiffness_N_per_mm: found 25, accepted at most the coupling's 20"));
  EXPECT_THAT(refusal_with("at_mm: [0, 0, 400]", "at_mm: [0, 0, 4000]"),
              HasSubstr("from the elbow at the start to its zones' bounds"));
  const std::string text = CellText("demo");
  const std::size_t depth = text.find("depth_limit:"), at = text.find("at_mm:", depth);
  std::string above = text;
  above.replace(at, text.find(']', at) + 1 - at, "at_mm: [620, 0, 4000]");
  EXPECT_THAT(Refusal(above),
              HasSubstr("from the apex at the start to the depth limit's bound, accepted at least 0 mm"));
  EXPECT_THAT(refusal_with("shape: box", "shape: cone"),
              HasSubstr("half_space, sphere, box, cylinder, capsule"));
}

}  // namespace
}  // namespace osteon::config
