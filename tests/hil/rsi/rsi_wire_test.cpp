#include "hil/rsi/rsi_wire.h"

#include <string_view>

#include <gtest/gtest.h>

// Tests the simulated controller's own writer of the RSI message <Rob> and its reader of the answer <Sen>.

namespace osteon::hil {
namespace {

// The answer that the reader finds in this text, or the reader's error.
tl::expected<SenMessage, std::string> Read(std::string_view text, RsiFormat format, bool cartesian = false) {
  return ReadSen({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, format, cartesian);
}

// Valid answers in both layouts (KROSHU and ImFree), with corrections of the axes and of the pose.
const std::string kKroshu =
    R"(<Sen Type="KROSHU"><Stop>0</Stop><AK A1="1.5" A2="-2" A3="0.000000" A4="4" A5="5" A6="6"/>)"
    R"(<IPOC>12345</IPOC></Sen>)";
const std::string kImFree =
    R"(<Sen Type="ImFree"><RKorr X="1.5" Y="-2" Z="0.0000" A="4" B="5" C="6"/><IPOC>12345</IPOC></Sen>)";

TEST(RsiWire, WritesRobMessagesInBothLayouts) {
  RobMessage m{.pose_measured = {1, 2, 3, 4, 5, 6},
               .pose_set = {1, 2, 3, 4, 5, 7},
               .axes_measured = {-1.23456, 0, 0, 0, 0, 0},
               .delay = 2,
               .ipoc = 99};
  EXPECT_EQ(WriteRob(m),
            R"(<Rob Type="KUKA"><RIst X="1.0000" Y="2.0000" Z="3.0000" A="4.0000" B="5.0000" C="6.0000"/>)"
            R"(<RSol X="1.0000" Y="2.0000" Z="3.0000" A="4.0000" B="5.0000" C="7.0000"/>)"
            R"(<AIPos A1="-1.2346" A2="0.0000" A3="0.0000" A4="0.0000" A5="0.0000" A6="0.0000"/>)"
            R"(<ASPos A1="0.0000" A2="0.0000" A3="0.0000" A4="0.0000" A5="0.0000" A6="0.0000"/>)"
            R"(<EIPos E1="0.0000" E2="0.0000" E3="0.0000" E4="0.0000" E5="0.0000" E6="0.0000"/>)"
            R"(<MACur A1="0.0000" A2="0.0000" A3="0.0000" A4="0.0000" A5="0.0000" A6="0.0000"/>)"
            R"(<Delay D="2"/><IPOC>99</IPOC></Rob>)");
  m.format = RsiFormat::kKroshu;
  EXPECT_EQ(WriteRob(m),
            R"(<Rob Type="KUKA"><RIst X="1.0000" Y="2.0000" Z="3.0000" A="4.0000" B="5.0000" C="6.0000"/>)"
            R"(<AIPos A1="-1.2346" A2="0.0000" A3="0.0000" A4="0.0000" A5="0.0000" A6="0.0000"/>)"
            R"(<EIPos E1="0.0000" E2="0.0000" E3="0.0000" E4="0.0000" E5="0.0000" E6="0.0000"/>)"
            R"(<Delay D="2"/><IPOC>99</IPOC></Rob>)");
}

TEST(RsiWire, ReadsAnswersOfBothLayouts) {
  const auto axes = Read(kKroshu, RsiFormat::kKroshu);
  ASSERT_TRUE(axes) << axes.error();
  EXPECT_EQ(axes->correction, (Six{1.5, -2, 0, 4, 5, 6}));
  EXPECT_EQ(axes->ipoc, 12345u);
  EXPECT_FALSE(axes->stop);
  const auto frame = Read(kImFree, RsiFormat::kImFree, true);
  ASSERT_TRUE(frame) << frame.error();
  EXPECT_EQ(frame->correction, (Six{1.5, -2, 0, 4, 5, 6}));
  // in the layout ImFree, the elements may have any order, with other elements between them
  const auto mixed = Read(R"(<Sen Type="ImFree"><EStr>hello</EStr><IPOC>7</IPOC><Tech T21="1.09"/>)"
                          R"(<AK A1="1" A2="2" A3="3" A4="4" A5="5" A6="6"/></Sen>)",
                          RsiFormat::kImFree);
  ASSERT_TRUE(mixed) << mixed.error();
  EXPECT_EQ(mixed->ipoc, 7u);
}

// In the layout KROSHU, the reader expects each character of the text at its place. Any other spacing, order
// or quotation mark must be refused.
TEST(RsiWire, KroshuAcceptsOnlyItsExactText) {
  const auto refused = [](std::string_view what, std::string_view by) {
    std::string text = kKroshu;
    text.replace(text.find(what), what.size(), by);
    return !Read(text, RsiFormat::kKroshu);
  };
  EXPECT_TRUE(refused("<AK A1", "<AK  A1"));
  EXPECT_TRUE(refused("\"/>", "\" />"));
  EXPECT_TRUE(refused("A2", "A3"));
  EXPECT_TRUE(refused("<Stop>0</Stop>", ""));
  EXPECT_TRUE(refused("<Stop>0", "<Stop>2"));
  EXPECT_TRUE(refused("\"1.5\"", "'1.5'"));
  EXPECT_TRUE(refused("\"1.5\"", "\"nan\""));
  EXPECT_TRUE(refused("KROSHU", "ImFree"));
  EXPECT_TRUE(refused("</Sen>", "</Sen> "));
  const auto error = Read("<Sen Type=\"KROSHU\"><Stop>0</Stop><RKorr", RsiFormat::kKroshu);
  ASSERT_FALSE(error);
  EXPECT_EQ(error.error(), "Sen: byte 33: expected '<AK'");
}

TEST(RsiWire, RefusesAnswersCutOffAtAnyByte) {
  for (std::size_t size = 0; size < kKroshu.size(); ++size)
    ASSERT_FALSE(Read(std::string_view(kKroshu).substr(0, size), RsiFormat::kKroshu)) << size;
  for (std::size_t size = 0; size < kImFree.size(); ++size)
    ASSERT_FALSE(Read(std::string_view(kImFree).substr(0, size), RsiFormat::kImFree, true)) << size;
}

}  // namespace
}  // namespace osteon::hil
