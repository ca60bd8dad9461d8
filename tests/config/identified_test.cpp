#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "config/reading/apply_identified.h"
#include "config/reading/load.h"
#include "config/reading/load_identified.h"
#include "config/reading/strict/config_error.h"
#include "tests/temporary_path.h"

// Tests the file of identified values (measured arm, sensor, link and hands): writing, reading, checks, and
// applying the values to a cell.

namespace osteon::config {
namespace {

// Identified values with an entry in every section.
IdentifiedCell Sample() {
  IdentifiedCell cell;
  cell.valid_for = {.robot = "LBR iiwa 14 R820",
                    .tool = "reamer",
                    .period_s = 1e-3,
                    .start_rad = {0.1, 0.2, 0.3, -1.234567890123, 0.5, 0.6, -0.7},
                    .recordings = {{.file = "free_z.mcap", .hash = "00112233aabbccdd"}}};
  cell.arm.push_back({.axis = "z",
                      .speed_m_per_s = 0.008,
                      .bandwidth_hz = 16.6,
                      .damping_ratio = 1.24,
                      .dead_time_s = 4.56e-3,
                      .gain = 0.9987,
                      .lag_s = 28.3e-3,
                      .felt_mass_kg = 5.22,
                      .chi2 = 1.1,
                      .bandwidth_interval_hz = {.low = 15.6, .high = 17.6},
                      .damping_interval = {.low = 1.2, .high = 1.3},
                      .dead_time_interval_s = {.low = 4.5e-3, .high = 4.6e-3},
                      .lag_interval_s = {.low = 28.2e-3, .high = 28.4e-3}});
  cell.response.push_back({.axis = "z",
                           .speed_m_per_s = 0.008,
                           .by_force = true,
                           .lines = {{.hz = 0.75, .re = 0.999, .im = -0.1, .sd = 1e-5},
                                     {.hz = 59.75, .re = -0.01, .im = -0.0123456789, .sd = 2e-5}}});
  cell.sensor = IdentifiedSensor{.delay_s = 1.684e-3, .noise_N = 0.078, .drift_N = 0.07};
  cell.link = IdentifiedLink{.jitter_mean_s = 1e-5, .jitter_p99_s = 7e-5, .loss_ratio = 0.01};
  cell.structure = {{.hz = 35.0, .damping_ratio = 0.03}};
  cell.hands = {{.name = "firm",
                 .stiffness_N_per_m = 3031,
                 .stiffness_interval_N_per_m = {.low = 2965, .high = 3097},
                 .damping_Ns_per_m = 21.2,
                 .mass_kg = 1.52}};
  cell.vibration = IdentifiedVibration{.tremor_N = 1.5, .notch_hz = {2.5}};
  cell.dead_zone_N = 0.21;
  return cell;
}

// Writes a temporary file of this name, and returns its path.
std::filesystem::path WriteFile(const std::string& name, const std::string& text) {
  const std::filesystem::path file = TemporaryPath(name);
  std::ofstream(file) << text;
  return file;
}

// The error of reading a file of this text; empty if the file is accepted.
std::string ErrorOf(const std::string& text) {
  try {
    static_cast<void>(ReadIdentified(WriteFile("identified.yaml", text)));
  } catch (const ConfigError& refused) {
    return refused.what();
  }
  return "";
}

// The text with the first occurrence of `from` replaced.
std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

TEST(IdentifiedFile, ReadsBackWhatWasWritten) {
  const IdentifiedCell sample = Sample();
  const std::string text = WriteIdentified(sample, "Written by\n  osteon identify");
  EXPECT_EQ(text.rfind("# Written by\n#   osteon identify\nidentified:\n", 0), 0u);
  const IdentifiedCell read = ReadIdentified(WriteFile("identified.yaml", text));
  EXPECT_EQ(WriteIdentified(read, "Written by\n  osteon identify"), text);
  EXPECT_EQ(read.valid_for.robot, sample.valid_for.robot);
  EXPECT_EQ(read.valid_for.recordings.at(0).hash, "00112233aabbccdd");
  EXPECT_NEAR(read.valid_for.start_rad[3], sample.valid_for.start_rad[3], 1e-9);
  ASSERT_EQ(read.arm.size(), 1u);
  EXPECT_NEAR(read.arm[0].dead_time_s, 4.56e-3, 1e-12);
  EXPECT_NEAR(read.arm[0].lag_interval_s.high, 28.4e-3, 1e-11);
  EXPECT_EQ(read.arm[0].felt_mass_kg, 5.22);
  ASSERT_EQ(read.response.size(), 1u);
  EXPECT_TRUE(read.response[0].by_force);
  EXPECT_EQ(read.response[0].lines.at(1).im, -0.0123456789);
  EXPECT_NEAR(*read.sensor->delay_s, 1.684e-3, 1e-12);
  EXPECT_EQ(read.link->loss_ratio, 0.01);
  EXPECT_EQ(read.structure.at(0).hz, 35.0);
  EXPECT_EQ(read.hands.at(0).stiffness_interval_N_per_m.low, 2965);
  EXPECT_EQ(read.vibration->tremor_N, 1.5);
  EXPECT_EQ(read.vibration->notch_hz, std::vector<double>{2.5});
  EXPECT_EQ(read.dead_zone_N, 0.21);
}

TEST(IdentifiedFile, SectionsThatWereNotMeasuredStayAbsent) {
  IdentifiedCell sample = Sample();
  sample = {.valid_for = sample.valid_for, .arm = {}, .response = {}};
  const IdentifiedCell read = ReadIdentified(WriteFile("identified.yaml", WriteIdentified(sample, "")));
  EXPECT_TRUE(read.arm.empty() && read.response.empty() && read.structure.empty() && read.hands.empty());
  EXPECT_FALSE(read.sensor || read.link || read.vibration || read.dead_zone_N);
}

TEST(IdentifiedFile, ErrorsNameLineValueAndWhatIsAccepted) {
  const std::string good = WriteIdentified(Sample(), "");
  EXPECT_EQ(ErrorOf(good), "");
  EXPECT_NE(ErrorOf(Replaced(good, "bandwidth_hz: 16.6", "bandwidth_hz: -1"))
                .find("bandwidth_hz: found -1, accepted"),
            std::string::npos);
  EXPECT_NE(ErrorOf(Replaced(good, "axis: z", "axis: w")).find("found w, accepted x, y, z"),
            std::string::npos);
  EXPECT_NE(ErrorOf(Replaced(good, "lag_ms: [28.2, 28.4]", "lag_ms: [28.35, 28.4]"))
                .find("found 28.35 … 28.4, accepted an interval around the value beside it, 28.3"),
            std::string::npos);
  // each value is in its range, but contradicts another value of the file
  EXPECT_NE(ErrorOf(Replaced(Replaced(good, "bandwidth_hz: 16.6", "bandwidth_hz: 900"),
                             "bandwidth_hz: [15.6, 17.6]", "bandwidth_hz: [800, 1000]"))
                .find("lag_ms: found 28.3, accepted dead_time_ms + 2 damping_ratio"),
            std::string::npos);
  EXPECT_NE(ErrorOf(Replaced(good, "delay_ms: 1.684", "delay_ms: -1000")).find("accepted -10 … 50"),
            std::string::npos);
  EXPECT_NE(ErrorOf(Replaced(good, "hash: \"00112233aabbccdd\"", "hash: \"zzz\""))
                .find("found zzz, accepted 16 hexadecimal digits"),
            std::string::npos);
  IdentifiedCell twice = Sample();
  twice.arm.push_back(twice.arm[0]);
  EXPECT_NE(ErrorOf(WriteIdentified(twice, "")).find("axis: found z at this speed twice"), std::string::npos);
  EXPECT_NE(
      ErrorOf(Replaced(good, "notch_hz: 2.5", "notch_hz: 25")).find("notch_hz: found 25, accepted 0 … 20"),
      std::string::npos);
  EXPECT_NE(ErrorOf(Replaced(good, "hz: 59.75", "hz: 0.5")).find("found 0.5 after 0.75, accepted rising"),
            std::string::npos);
  EXPECT_NE(ErrorOf(Replaced(good, "chi2_ratio", "chi_ratio")).find("chi_ratio"), std::string::npos);
  const std::string error = ErrorOf(Replaced(good, "noise_N: 0.078", "noise_N: often"));
  EXPECT_NE(error.find("identified.yaml:"), std::string::npos) << error;
  EXPECT_NE(error.find("noise_N: found often"), std::string::npos) << error;
}

TEST(IdentifiedFile, AResponseMeasuredWithAHandMustNameAListedHand) {
  IdentifiedCell cell = Sample();
  cell.response.push_back({.axis = "z",
                           .speed_m_per_s = 0.008,
                           .hand = "firm",
                           .lines = {{.hz = 0.75, .re = 1.0, .im = 0.0, .sd = 1e-3},
                                     {.hz = 1.25, .re = 0.9, .im = -0.1, .sd = 1e-3}}});
  cell.response.push_back(
      {.axis = "x", .speed_m_per_s = 0.008, .spring_N_per_m = 1978.0, .lines = cell.response.back().lines});
  const std::string good = WriteIdentified(cell, "");
  const IdentifiedCell read = ReadIdentified(WriteFile("identified.yaml", good));
  ASSERT_EQ(read.response.size(), 3u);
  EXPECT_TRUE(read.response[0].hand.empty());
  EXPECT_EQ(read.response[1].hand, "firm");
  EXPECT_FALSE(read.response[1].by_force);
  EXPECT_EQ(read.response[2].spring_N_per_m, 1978.0);
  EXPECT_EQ(WriteIdentified(read, ""), good);
  EXPECT_NE(ErrorOf(Replaced(good, "hand: \"firm\"", "hand: \"soft\""))
                .find("hand: found soft, accepted a name of hands: firm"),
            std::string::npos);
  EXPECT_NE(ErrorOf(Replaced(good, "      hand: \"firm\"\n", "")).find("found hand without a key hand"),
            std::string::npos);
  EXPECT_NE(ErrorOf(Replaced(good, "by: hand", "by: force")).find("accepted by: hand"), std::string::npos);
}

// Identified values without any measurement, for this cell's robot, tool, period and start.
IdentifiedCell EmptyIdentifiedFor(const CellConfig& cell) {
  IdentifiedCell own{
      .valid_for = {.robot = cell.robot.name, .tool = cell.tool.tool.name, .period_s = cell.servo.period_s}};
  for (std::size_t i = 0; i < 7; ++i) own.valid_for.start_rad[i] = cell.start.q[static_cast<int>(i)];
  return own;
}

TEST(IdentifiedFile, TremorNotchAndDeadZoneReachTheLoop) {
  CellConfig cell = LoadCell(std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml");
  IdentifiedCell own = EmptyIdentifiedFor(cell);
  const auto apply = [&](const IdentifiedCell& identified) {
    CellConfig applied = cell;
    ApplyIdentified(WriteFile("identified.yaml", WriteIdentified(identified, "")), applied);
    return applied;
  };
  EXPECT_THROW(apply(own), ConfigError) << "it says nothing";
  own.vibration = IdentifiedVibration{.tremor_N = 0.7, .notch_hz = {3.0}};
  own.dead_zone_N = 0.4;
  const CellConfig applied = apply(own);
  EXPECT_EQ(applied.servo.vibration.reference.tremor_N, 0.7);
  EXPECT_EQ(applied.servo.vibration.notch_hz, 3.0);
  EXPECT_EQ(applied.servo.admittance.dead_zone_N, std::max(0.4, cell.servo.admittance.dead_zone_N));
  EXPECT_EQ(applied.own_gains.dead_zone_N, applied.servo.admittance.dead_zone_N);
  EXPECT_EQ(applied.simulated.servo.bandwidth_hz, cell.simulated.servo.bandwidth_hz);
  cell.servo.admittance.dead_zone_N = 2.0;
  EXPECT_EQ(apply(own).servo.admittance.dead_zone_N, 2.0) << "a measured drift makes no dead zone smaller";
}

TEST(IdentifiedFile, UnderImpedanceDeadTimeAndStiffnessReachTheSimulatedArm) {
  const CellConfig cell =
      LoadCell(std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/thin_plate_impedance.yaml");
  IdentifiedCell own = EmptyIdentifiedFor(cell);
  own.arm = Sample().arm;
  own.arm[0].bandwidth_hz = 3.0;
  own.arm[0].bandwidth_interval_hz = {.low = 2.9, .high = 3.1};
  const auto apply = [&](double dead_time_s, std::optional<control::Law> law) {
    own.arm[0].dead_time_s = dead_time_s;
    own.arm[0].dead_time_interval_s = {.low = dead_time_s - 1e-4, .high = dead_time_s + 1e-4};
    const double lag_s =
        dead_time_s + own.arm[0].damping_ratio / (std::numbers::pi * own.arm[0].bandwidth_hz);
    own.arm[0].lag_s = lag_s;
    own.arm[0].lag_interval_s = {.low = lag_s - 1e-4, .high = lag_s + 1e-4};
    CellConfig applied = cell;
    ApplyIdentified(WriteFile("identified.yaml", WriteIdentified(own, "", law)), applied);
    return applied.simulated.dynamic;
  };
  EXPECT_EQ(apply(4.02e-3, control::Law::kImpedance).dead_cycles, 4) << "a measured dead time is not exact";
  const hil::DynamicArmParams arm = apply(4.2e-3, {});
  EXPECT_EQ(arm.dead_cycles, 5) << "the later one";
  EXPECT_NEAR(arm.stiffness_N_per_m, 5.22 * std::pow(6.0 * std::numbers::pi, 2), 1e-6)
      << "of a file without springs";
  EXPECT_EQ(arm.bandwidth_hz, cell.simulated.dynamic.bandwidth_hz) << "of the position controller";
  EXPECT_THROW(apply(40e-3, {}), ConfigError);
  try {
    static_cast<void>(apply(4e-3, control::Law::kAdmittance));
    FAIL() << "another law's file";
  } catch (const ConfigError& refused) {
    EXPECT_NE(std::string(refused.what()).find("law: found admittance, accepted impedance"),
              std::string::npos)
        << refused.what();
  }
}

TEST(IdentifiedFile, EachSpringComesFromTheAxisWithTheSmallestUncertainty) {
  const CellConfig cell =
      LoadCell(std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/thin_plate_impedance.yaml");
  IdentifiedCell own = EmptyIdentifiedFor(cell);
  own.arm = {Sample().arm[0], Sample().arm[0]};
  IdentifiedArm &x = own.arm[0], &z = own.arm[1];
  x.axis = "x";
  // the bandwidth's interval is wider than that of z, but the damping is known more exactly
  x.bandwidth_interval_hz = {.low = 15.0, .high = 18.2};
  x.damping_interval = {.low = 1.23, .high = 1.25};
  x.impedance =
      IdentifiedImpedance{.translation_N_per_m = 1900.0, .rotation_Nm_per_rad = 204.0, .damping_ratio = 0.7};
  z.impedance = IdentifiedImpedance{.translation_N_per_m = 1980.0, .damping_ratio = 0.9, .on_mount = true};
  CellConfig applied = cell;
  const std::string text = WriteIdentified(own, "", control::Law::kImpedance);
  ApplyIdentified(WriteFile("identified.yaml", text), applied);
  const hil::DynamicArmParams& arm = applied.simulated.dynamic;
  EXPECT_EQ(arm.stiffness_N_per_m, 1980.0);
  EXPECT_EQ(arm.stiffness_Nm_per_rad_turn, 204.0) << "the only one";
  EXPECT_EQ(arm.cartesian_damping_ratio, 0.7);
  EXPECT_EQ(arm.joint_damping_ratio, cell.simulated.dynamic.joint_damping_ratio) << "of another overlay";
  EXPECT_TRUE(applied.identified->arm.at(1).impedance->on_mount);
  EXPECT_EQ(
      IdentifiedText(applied).at(0),
      "simulated arm: 1980 N/m, 204 N·m/rad, damping ratio 0.7, dead time 5 ms (rounded up to whole periods)")
      << "the arm's springs, not the lag that the admittance law meets";
  EXPECT_NE(ErrorOf(Replaced(text, "rotation_Nm_per_rad: 204", "rotation_Nm_per_rad: -204"))
                .find("rotation_Nm_per_rad: found -204, accepted"),
            std::string::npos);
}

TEST(IdentifiedFile, AFileGivenAtLoadReplacesTheCellsValues) {
  const std::filesystem::path demo = std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml";
  IdentifiedCell measured = EmptyIdentifiedFor(LoadCell(demo));
  measured.arm = Sample().arm;
  measured.sensor = Sample().sensor;
  measured.dead_zone_N = 0.9;
  const std::filesystem::path file = WriteFile("instead.yaml", WriteIdentified(measured, ""));
  const CellConfig cell = LoadCell(demo, {}, {}, file);
  EXPECT_EQ(cell.simulated.servo.bandwidth_hz, 16.6);
  EXPECT_EQ(cell.servo.admittance.dead_zone_N, 0.9);
  const std::vector<std::string> lines = IdentifiedText(cell);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0],
            "simulated arm: 16.6 Hz, damping ratio 1.24, dead time 4.56 ms (axis z at 8 mm/s, the slowest)");
  EXPECT_EQ(lines[1], "delay of the force sensor: 1.68 ms, in the figure of the latency");
  EXPECT_EQ(lines[2], "dead zone: 0.9 N, measured 0.9");
  EXPECT_TRUE(IdentifiedText(LoadCell(demo)).empty());

  measured.valid_for.tool = "broach";
  const std::filesystem::path other = WriteFile("other.yaml", WriteIdentified(measured, ""));
  EXPECT_THROW(static_cast<void>(LoadCell(demo, {}, {}, other)), ConfigError) << "another cell's";
}

TEST(IdentifiedFile, AFileOfAnotherCellIsRefused) {
  const CellConfig cell = LoadCell(std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml");
  IdentifiedCell own = Sample();
  own.valid_for.robot = cell.robot.name;
  own.valid_for.tool = cell.tool.tool.name;
  own.valid_for.period_s = cell.servo.period_s;
  for (std::size_t i = 0; i < 7; ++i) own.valid_for.start_rad[i] = cell.start.q[static_cast<int>(i)];
  const auto error = [&](const IdentifiedCell& identified) -> std::string {
    try {
      static_cast<void>(
          ReadIdentifiedFor(WriteFile("identified.yaml", WriteIdentified(identified, "")), cell));
    } catch (const ConfigError& refused) {
      return refused.what();
    }
    return "";
  };
  EXPECT_EQ(error(own), "");
  IdentifiedCell other = own;
  other.valid_for.robot = "another";
  EXPECT_NE(error(other).find("robot: found another, accepted " + cell.robot.name), std::string::npos);
  other = own;
  other.valid_for.tool = "broach";
  EXPECT_NE(error(other).find("tool: found broach"), std::string::npos);
  other = own;
  other.valid_for.period_s = 4e-3;
  EXPECT_NE(error(other).find("period_ms: found 4, accepted 1"), std::string::npos);
  other = own;
  other.valid_for.start_rad[2] += 0.05;
  EXPECT_NE(error(other).find("for joint 3"), std::string::npos);
}

}  // namespace
}  // namespace osteon::config
