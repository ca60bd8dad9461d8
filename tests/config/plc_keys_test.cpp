#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cell_text.h"

// Tests the section plc. A cell must either have this section or state that it has no PLC (without_plc:
// accepted).

namespace osteon::config {
namespace {

using testing::AllOf, testing::HasSubstr;

// The demo cell without its section plc.
std::string DemoWithoutPlc() {
  const std::string yaml = CellText("demo");
  const std::size_t from = yaml.find("\nplc:") + 1;
  std::size_t to = yaml.find('\n', from) + 1;
  while (yaml[to] == ' ' || yaml[to] == '#') to = yaml.find('\n', to) + 1;
  return yaml.substr(0, from) + yaml.substr(to);
}

TEST(PlcKeys, ACellWithoutPlcMustSaySo) {
  EXPECT_THAT(Refusal(DemoWithoutPlc()),
              AllOf(HasSubstr("plc: found none"), HasSubstr("without_plc: accepted")));
}

TEST(PlcKeys, ACellThatAcceptsToHaveNoPlcHasNoInterlock) {
  const CellConfig cell = LoadText(DemoWithoutPlc() + "\nwithout_plc: accepted\n");
  EXPECT_FALSE(cell.devices.plc);
  EXPECT_FALSE(cell.servo.has_interlock);
  EXPECT_TRUE(LoadText(CellText("demo")).servo.has_interlock);
}

TEST(PlcKeys, WithoutPlcAcceptsOnlyItsWordAndNoSectionPlcBesideIt) {
  EXPECT_THAT(Refusal(DemoWithoutPlc() + "\nwithout_plc: true\n"),
              AllOf(HasSubstr("without_plc: found"), HasSubstr("accepted")));
  EXPECT_THAT(Refusal(CellText("demo") + "\nwithout_plc: accepted\n"),
              HasSubstr("without_plc: found beside plc"));
}

}  // namespace
}  // namespace osteon::config
