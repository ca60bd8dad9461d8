#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "config/reading/simulated/read_operator.h"

// Tests a cell's section operator: the simulated hand and its incidents (sudden grip, release, clamp).

namespace osteon::config {
namespace {

const std::string kHand =
    "operator:\n  stiffness_N_per_m: 300\n  damping_Ns_per_m: 20\n  mass_kg: 1.5\n  stiffness_Nm_per_rad: 5\n"
    "  damping_Nms_per_rad: 0.2\n  inertia_kg_m2: 0.01\n  grip_time_ms: 5\n  max_force_N: 150\n  "
    "max_torque_Nm: 10\n"
    "  tremor_N: 0\n  tremor_seed: 1\n";
const std::string kIncidents =
    "  incidents:\n"
    "    - kind: grip_step\n      at_s: 3\n      until_s: 4\n      stiffness_N_per_m: 6000\n"
    "      damping_Ns_per_m: 60\n      stiffness_Nm_per_rad: 80\n      damping_Nms_per_rad: 0.9\n"
    "      return_ms: 300\n"
    "    - kind: startled_release\n      at_s: 5\n      jerk_N: 40\n      jerk_ms: 50\n"
    "      jerk_axis: [0, 0.6, 0.8]\n      release_ms: 30\n      away_ms: 200\n      return_ms: 250\n"
    "    - kind: clamp\n      at_s: 6\n      stiffness_N_per_m: 50000\n      damping_Ns_per_m: 50\n"
    "      stiffness_Nm_per_rad: 500\n      damping_Nms_per_rad: 0.5\n      return_ms: 100\n";

// The hand read from the text of a cell.
hil::OperatorHandParams ReadHand(const std::string& text) {
  Reader reader = Reader::Parse(text, "cell.yaml");
  hil::OperatorHandParams hand;
  ReadOperator(reader.Section("operator"), hand);
  reader.Finish();
  return hand;
}

// The error of ReadHand for this text; "accepted" if there is none.
std::string ErrorOf(const std::string& text) {
  try {
    (void)ReadHand(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "accepted";
}

// The text with the first occurrence of `from` replaced.
std::string Changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(OperatorSection, IncidentsAreOptional) {
  const hil::OperatorHandParams hand = ReadHand(kHand);
  EXPECT_EQ(hand.stiffness_N_per_m, 300.0);
  EXPECT_EQ(hand.grip_time_s, 0.005);
  EXPECT_EQ(hand.incidents.count, 0u);
}

TEST(OperatorSection, IncidentsAreConvertedToSi) {
  const hil::OperatorHandParams hand = ReadHand(kHand + kIncidents);
  ASSERT_EQ(hand.incidents.count, 3u);
  const auto& step = std::get<hil::GripStep>(hand.incidents.list[0]);
  EXPECT_DOUBLE_EQ(step.begin_s, 3.0);
  EXPECT_DOUBLE_EQ(step.end_s, 4.0);
  EXPECT_DOUBLE_EQ(step.return_s, 0.3);
  EXPECT_DOUBLE_EQ(step.spring.stiffness_N_per_m, 6000.0);
  EXPECT_DOUBLE_EQ(step.spring.damping_Ns_per_m, 60.0);
  EXPECT_DOUBLE_EQ(step.spring.stiffness_Nm_per_rad, 80.0);
  EXPECT_DOUBLE_EQ(step.spring.damping_Nms_per_rad, 0.9);
  const auto& release = std::get<hil::StartledRelease>(hand.incidents.list[1]);
  EXPECT_DOUBLE_EQ(release.begin_s, 5.0);
  EXPECT_DOUBLE_EQ(release.jerk_N, 40.0);
  EXPECT_DOUBLE_EQ(release.jerk_s, 0.05);
  EXPECT_DOUBLE_EQ(release.jerk_C.z, 0.8);
  EXPECT_DOUBLE_EQ(release.release_s, 0.03);
  EXPECT_DOUBLE_EQ(release.away_s, 0.2);
  EXPECT_DOUBLE_EQ(release.return_s, 0.25);
  const auto& clamp = std::get<hil::RigidClamp>(hand.incidents.list[2]);
  EXPECT_DOUBLE_EQ(clamp.begin_s, 6.0);
  EXPECT_TRUE(std::isinf(clamp.end_s)) << "never ends";
  EXPECT_DOUBLE_EQ(clamp.spring.stiffness_N_per_m, 50000.0);
  // CheckIncidents must accept the incidents that were read
  EXPECT_NO_THROW(hil::CheckIncidents(hand.incidents));
  const std::string first_two = kIncidents.substr(0, kIncidents.find("    - kind: clamp"));
  const auto forever = ReadHand(kHand + Changed(first_two, "      away_ms: 200\n", ""));
  EXPECT_TRUE(std::isinf(std::get<hil::StartledRelease>(forever.incidents.list[1]).away_s));
}

// Replaces each number in turn by ±1e12. It must be refused, and the error must name its line.
TEST(OperatorSection, EveryNumberHasARange) {
  std::istringstream stream(kHand + kIncidents);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  int numbers = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t colon = lines[i].find(": ");
    if (colon == std::string::npos || lines[i].find("kind") != std::string::npos) continue;
    const std::size_t begin = lines[i].find_first_not_of(" ");
    const std::string key = lines[i].substr(begin, colon - begin);
    for (const std::string absurd : {"1e12", "-1e12"}) {
      std::string text;
      for (std::size_t j = 0; j < lines.size(); ++j)
        text += (j != i               ? lines[j]
                 : key == "jerk_axis" ? "      jerk_axis: [0, " + absurd + ", 0]"
                                      : lines[i].substr(0, colon) + ": " + absurd) +
                "\n";
      const std::string error = ErrorOf(text);
      EXPECT_TRUE(error.starts_with("cell.yaml:" + std::to_string(i + 1) + ": " + key + ": found " + absurd +
                                    ", accepted "))
          << error;
    }
    ++numbers;
  }
  EXPECT_EQ(numbers, 11 + 8 - 1 + 7 + 6);  // each line with a number was tried
}

TEST(OperatorSection, IncidentsThatContradictEachOtherAreRefused) {
  const std::string all = kHand + kIncidents;
  EXPECT_EQ(ErrorOf(Changed(all, "until_s: 4", "until_s: 2")),
            "cell.yaml:16: until_s: found 2, accepted more than at_s (3)");
  EXPECT_EQ(ErrorOf(Changed(all, "at_s: 5", "at_s: 4.2")),
            "cell.yaml:23: at_s: found 4.2, accepted at least 4.3, when the one before is over");
  EXPECT_EQ(ErrorOf(Changed(all, "at_s: 6", "at_s: 2")),
            "cell.yaml:31: at_s: found 2, accepted at least 5.53, when the one before is over");
  EXPECT_EQ(ErrorOf(Changed(all, "      until_s: 4\n", "")),
            "cell.yaml:22: at_s: found 5 after an incident that never ends");
  EXPECT_EQ(ErrorOf(Changed(all, "jerk_N: 40", "jerk_N: 160")),
            "cell.yaml:24: jerk_N: found 160, accepted at most the hand's max_force_N (150)");
  EXPECT_EQ(ErrorOf(Changed(all, "jerk_axis: [0, 0.6", "jerk_axis: [0, 0")),
            "cell.yaml:26: jerk_axis: found a length of 0.8, accepted 1");
}

TEST(OperatorSection, MisspeltMissingAndForeignKeysAreNamed) {
  const std::string all = kHand + kIncidents;
  EXPECT_EQ(ErrorOf(Changed(all, "kind: clamp", "kind: vice")),
            "cell.yaml:30: kind: found vice, accepted grip_step, clamp, startled_release");
  EXPECT_EQ(ErrorOf(Changed(all, "until_s", "untill_s")),
            "cell.yaml:16: unknown key \"untill_s\"; did you mean \"until_s\"?");
  EXPECT_EQ(ErrorOf(Changed(all, "      release_ms: 30\n", "")),
            "cell.yaml:22: missing key \"release_ms\", accepted 1 … 1000");
  EXPECT_EQ(ErrorOf(Changed(all, "mass_kg", "mas_kg")),
            "cell.yaml:4: unknown key \"mas_kg\"; did you mean \"mass_kg\"?");
  EXPECT_EQ(ErrorOf(Changed(kHand + kIncidents, "until_s: 4", "jerk_N: 4")),
            "cell.yaml:16: unknown key \"jerk_N\", accepted at_s, damping_Nms_per_rad, damping_Ns_per_m, "
            "kind, return_ms, stiffness_N_per_m, stiffness_Nm_per_rad, until_s");
  EXPECT_NE(
      ErrorOf(kHand + "  incidents: []\n").find("incidents: found a list of 0, accepted a list of 1 … 8"),
      std::string::npos);
}

}  // namespace
}  // namespace osteon::config
