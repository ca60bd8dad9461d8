#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "tests/config/cell_text.h"

// Tests a cell's optional sections age_governor, passivity and energy_tank, which configure the loop's
// stabilisers.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

// The cell's text without one of its sections.
std::string Without(std::string yaml, const std::string& section) {
  const std::size_t from = yaml.find("\n" + section + ":"), to = yaml.find("\n\n", from);
  std::size_t end = yaml.find('\n', from + 1);
  while (yaml[end + 1] == ' ') end = yaml.find('\n', end + 1);
  if (from == std::string::npos || to == std::string::npos) throw std::logic_error("no section " + section);
  return yaml.erase(from, end - from);
}

TEST(StabiliserKeys, ReachTheLoop) {
  std::string text = CellText("thin_plate_impedance");
  text = With(
      text, "\nage_governor:", "\nage_governor:\n  arm_damping_Ns_per_m: 30\n  arm_damping_Nms_per_rad: 0.5");
  text = With(text, "\n  damping_ratio: 20", "\n  damping_ratio: 7");
  text = With(text, "\n  allowance_J: 0.02", "\n  allowance_J: 0.03");
  text = With(text, "\n  cap_J: 1\n", "\n  cap_J: 2\n");
  const control::StabiliserParams stabilisers = LoadText(text).servo.stabilisers;
  EXPECT_TRUE(stabilisers.age_governor.acts && stabilisers.passivity.acts && stabilisers.energy_tank.acts);
  EXPECT_EQ(stabilisers.age_governor.max_damping_factor, 7.0);
  EXPECT_EQ(stabilisers.age_governor.release_s, 0.2);
  EXPECT_EQ(stabilisers.age_governor.arm_damping_Ns_per_m, 30.0);
  EXPECT_EQ(stabilisers.age_governor.arm_damping_Nms_per_rad, 0.5);
  EXPECT_EQ(stabilisers.passivity.allowance_J, 0.03);
  EXPECT_EQ(stabilisers.passivity.min_speed_m_per_s, 0.005);
  EXPECT_EQ(stabilisers.passivity.max_damping_Ns_per_m, 1000.0);
  EXPECT_EQ(stabilisers.energy_tank.cap_J, 2.0);
  EXPECT_EQ(stabilisers.energy_tank.ramp_s, 0.1);
}

// Each value is in its range, but the governor would have to scale a damping of zero. The error must already
// be reported for the cell's file, not only by the loop's constructor.
TEST(StabiliserKeys, AnAgeGovernorWithoutAnyDampingIsRefused) {
  const std::string text = With(CellText("thin_plate_impedance"), "damping_Ns_per_m: [40, 40, 40]",
                                "damping_Ns_per_m: [40, 40, 0]");
  EXPECT_THAT(Refusal(text),
              AllOf(HasSubstr(".yaml:"), HasSubstr("impedance: impedance damping_Ns_per_m with the arm's"),
                    HasSubstr("found 0, accepted > 0")));
  EXPECT_EQ(Refusal(With(text, "\nage_governor:", "\nage_governor:\n  arm_damping_Ns_per_m: 30")), "");
}

TEST(StabiliserKeys, ASectionThatIsLeftOutHasTheDemosValues) {
  const std::string all = CellText("demo");
  std::string none = all;
  for (const char* section : {"age_governor", "passivity", "energy_tank"}) none = Without(none, section);
  const control::StabiliserParams shipped = LoadText(all).servo.stabilisers,
                                  absent = LoadText(none).servo.stabilisers;
  EXPECT_EQ(absent.age_governor.acts, shipped.age_governor.acts);
  EXPECT_EQ(absent.age_governor.max_damping_factor, shipped.age_governor.max_damping_factor);
  EXPECT_EQ(absent.age_governor.release_s, shipped.age_governor.release_s);
  EXPECT_EQ(absent.passivity.acts, shipped.passivity.acts);
  EXPECT_EQ(absent.passivity.allowance_J, shipped.passivity.allowance_J);
  EXPECT_EQ(absent.passivity.min_speed_m_per_s, shipped.passivity.min_speed_m_per_s);
  EXPECT_EQ(absent.passivity.max_damping_Ns_per_m, shipped.passivity.max_damping_Ns_per_m);
  EXPECT_EQ(absent.energy_tank.acts, shipped.energy_tank.acts);
  EXPECT_EQ(absent.energy_tank.cap_J, shipped.energy_tank.cap_J);
  EXPECT_EQ(absent.energy_tank.ramp_s, shipped.energy_tank.ramp_s);
  EXPECT_EQ(shipped.age_governor.tool_radius_m, 0.025) << "the reamer's";
}

TEST(StabiliserKeys, RefuseValuesOutOfRangeAndKeysOfAnotherLaw) {
  const std::string cell = CellText("demo");
  EXPECT_THAT(Refusal(With(cell, "\n  cap_J: 1 ", "\n  cap_J: -1 ")),
              AllOf(HasSubstr("cap_J"), HasSubstr("found -1"), HasSubstr("accepted 0")));
  EXPECT_THAT(Refusal(With(cell, "\n  allowance_J: 0.02", "\n  allowance_J: much")),
              HasSubstr("allowance_J"));
  EXPECT_THAT(Refusal(With(cell, "\n  damping_ratio: 20 ", "\n  damping_ratio: 0 ")),
              AllOf(HasSubstr("damping_ratio"), HasSubstr("accepted 1")));
  EXPECT_THAT(Refusal(With(cell, "\nage_governor:", "\nage_governor:\n  arm_damping_Ns_per_m: 30")),
              HasSubstr("arm_damping_Ns_per_m"));
}

}  // namespace
}  // namespace osteon::config
