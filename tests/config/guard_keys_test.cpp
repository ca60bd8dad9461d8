#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cell_text.h"

// Tests the keys in a cell's section guard, which configure the process that relays FRI messages between arm
// and controller and supervises them.

namespace osteon::config {
namespace {

using testing::HasSubstr;

// Text of a shipped cell, with a section guard that consists of these lines.
std::string WithGuard(const std::string& keys, const std::string& cell = "thin_plate") {
  return CellText(cell) + "\nguard:\n" + keys;
}

TEST(GuardKeys, ACellWithoutTheSectionHasNoGuard) { EXPECT_FALSE(LoadText(CellText("thin_plate")).guard); }

TEST(GuardKeys, HostIsTheLoopbackUnlessTheCellNamesOne) {
  const CellConfig plain = LoadText(WithGuard("  port: 30209\n"));
  ASSERT_TRUE(plain.guard);
  EXPECT_EQ(plain.guard->host, "127.0.0.1");
  EXPECT_EQ(plain.guard->port, 30209);
  EXPECT_EQ(plain.guard->margin, 0.25);
  EXPECT_EQ(plain.guard->silence_s, 0.05);
  const std::string keys = "  host: 192.168.1.5\n  port: 30205\n  margin_ratio: 0.1\n  silence_ms: 20\n";
  EXPECT_THAT(Refusal(WithGuard(keys)), HasSubstr("arm_host: found none with the address 192.168.1.5"));
  const CellConfig told = LoadText(With(WithGuard(keys), "fri:\n", "fri:\n  arm_host: 192.168.1.9\n"));
  EXPECT_EQ(told.link.arm_host, "192.168.1.9");
  EXPECT_EQ(told.guard->host, "192.168.1.5");
  EXPECT_EQ(told.guard->margin, 0.1);
  EXPECT_EQ(told.guard->silence_s, 0.02);
}

TEST(GuardKeys, RefusalNamesTheKeyTheValueAndWhatIsAccepted) {
  EXPECT_THAT(Refusal(WithGuard("  host: 127.0.0.1\n")), HasSubstr("port"));
  EXPECT_THAT(Refusal(WithGuard("  port: 80\n")),
              HasSubstr("port: found 80, accepted a whole number 1024 … 65535"));
  EXPECT_THAT(Refusal(WithGuard("  port: 30200\n")),
              HasSubstr("port: found 30200, accepted another one than fri's"));
  EXPECT_THAT(Refusal(WithGuard("  port: 30209\n  margin_ratio: 2\n")),
              HasSubstr("margin_ratio: found 2, accepted 0 … 1"));
  EXPECT_THAT(Refusal(WithGuard("  port: 30209\n  silence_ms: 1\n")), HasSubstr("accepted 5 … 1000"));
  EXPECT_THAT(Refusal(WithGuard("  port: 30209\n  prot: 1\n")), HasSubstr("prot"));
  EXPECT_THAT(Refusal(WithGuard("  port: 49153\n", "kr_16_thin_plate")),
              HasSubstr("guard: found beside rsi"));
}

}  // namespace
}  // namespace osteon::config
