#include "io/rsi/codec.h"

#include <clocale>
#include <cmath>
#include <limits>
#include <locale>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "io/rsi/xml_reader.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/rsi/rsi_oracle.h"

namespace osteon::io {
namespace {

using test::Bytes;
using test::Text;

// `needed`: RsiElement bits of the elements that must be present, besides IPOC.
RsiError Decode(std::string_view text, RsiRobotMessage& message, std::uint16_t needed = 0) {
  return DecodeRobot(Bytes(text), needed, message);
}

std::string Encode(const RsiAnswer& answer, int decimals) {
  std::array<std::uint8_t, 1000> buffer;
  std::size_t size = 0;
  EXPECT_EQ(EncodeAnswer(answer, decimals, buffer, size), RsiErrorCode::kNone);
  return Text({buffer.data(), size});
}

// Returns the text with the first occurrence of `what` replaced by `by`.
std::string ReplaceFirst(std::string text, std::string_view what, std::string_view by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST(RsiCodec, ReadsEveryElementOfTheFullLayout) {
  RsiRobotMessage m;
  const RsiError error = Decode(test::kFullRobot, m);
  ASSERT_FALSE(error) << Describe(error);
  EXPECT_EQ(m.ipoc, 4208163634u);
  EXPECT_EQ(m.ipoc_digits, 10);
  EXPECT_EQ(m.delay, 3u);
  EXPECT_EQ(m.pose_measured, (RsiFrame{1180.5, -20.25, 1290.125, -180.0, 0.5, 179.75}));
  EXPECT_EQ(m.pose_set, (RsiFrame{1180.0, -20.0, 1290.0, -180.0, 0.0, 180.0}));
  EXPECT_EQ(m.axes_measured, (RsiAxes{1.5, -90.25, 90.125, 0.0, 89.5, -0.0625}));
  EXPECT_EQ(m.axes_set, (RsiAxes{1.25, -90.5, 90.0, 0.25, 90.0, 0.0}));
  EXPECT_EQ(m.external_axes, (RsiAxes{10.5, 0.0, 0.0, 0.0, 0.0, -1.0}));
  EXPECT_EQ(m.motor_currents, (RsiAxes{1.0, -12.5, 6.25, 0.5, -0.75, 0.125}));
}

TEST(RsiCodec, ReadsTheShortLayoutAndLeavesAbsentElementsEmpty) {
  RsiRobotMessage m;
  ASSERT_FALSE(Decode(test::kShortRobot, m));
  EXPECT_EQ(m.ipoc, 12345u);
  EXPECT_EQ(m.ipoc_digits, 10);
  EXPECT_EQ(m.delay, 0u);
  EXPECT_TRUE(m.axes_measured && m.external_axes && m.pose_measured);
  EXPECT_FALSE(m.axes_set || m.pose_set || m.motor_currents);
}

// Both layouts, axis and Cartesian corrections, numbers rounded to 1, 4 and 6 decimals.
TEST(RsiCodec, WritesTheControllersExamplesByteForByte) {
  RsiAnswer answer{.correction = {1.5, -0.25, 0.0, -1e-7, 90.0, 0.12345}, .ipoc = 4208163634};
  EXPECT_EQ(Encode(answer, 4),
            "<Sen Type=\"ImFree\"><AK A1=\"1.5000\" A2=\"-0.2500\" A3=\"0.0000\" A4=\"0.0000\" "
            "A5=\"90.0000\" A6=\"0.1235\"/><IPOC>4208163634</IPOC></Sen>");
  answer.kind = RsiCorrection::kCartesian;
  EXPECT_EQ(Encode(answer, 1),
            "<Sen Type=\"ImFree\"><RKorr X=\"1.5\" Y=\"-0.2\" Z=\"0.0\" A=\"0.0\" B=\"90.0\" C=\"0.1\"/>"
            "<IPOC>4208163634</IPOC></Sen>");
  answer = {.layout = RsiLayout::kKroshu, .stop = true, .ipoc = 12345, .ipoc_digits = 10};
  EXPECT_EQ(Encode(answer, 6),
            "<Sen Type=\"KROSHU\"><Stop>1</Stop><AK A1=\"0.000000\" A2=\"0.000000\" A3=\"0.000000\" "
            "A4=\"0.000000\" A5=\"0.000000\" A6=\"0.000000\"/><IPOC>0000012345</IPOC></Sen>");
  answer.stop = false;
  EXPECT_NE(Encode(answer, 6).find("<Stop>0</Stop><AK "), std::string::npos);
}

// Random corrections in both layouts and of both kinds, rounded to 0 to 9 decimals.
TEST(RsiCodec, ExpatReadsEncodedAnswers) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> degrees(-180.0, 180.0);
  for (int i = 0; i < 500; ++i) {
    RsiAnswer answer{.layout = i % 2 ? RsiLayout::kImFree : RsiLayout::kKroshu,
                     .kind = i % 4 < 2 ? RsiCorrection::kAxes : RsiCorrection::kCartesian,
                     .ipoc = random()};
    for (double& value : answer.correction) value = degrees(random);
    const int decimals = i % 10;
    const auto read = test::ReadByExpat(Encode(answer, decimals));
    ASSERT_TRUE(read);
    ASSERT_EQ(read->at("Sen/Type"), i % 2 ? "ImFree" : "KROSHU");
    ASSERT_EQ(read->at("IPOC"), std::to_string(answer.ipoc));
    for (std::size_t k = 0; k < 6; ++k) {
      const std::string name =
          i % 4 < 2 ? "AK/A" + std::to_string(k + 1) : "RKorr/" + std::string(1, "XYZABC"[k]);
      const double found = std::stod(read->at(name));
      ASSERT_NEAR(found, answer.correction[k], 0.5000001 * std::pow(10.0, -decimals));
      ASSERT_EQ(found, RsiRounded(answer.correction[k], decimals)) << "what the session adds up";
    }
  }
}

TEST(RsiCodec, DecoderAndExpatReadTheSameValues) {
  for (const std::string& sample : {test::kFullRobot, test::kShortRobot}) {
    RsiRobotMessage m;
    ASSERT_FALSE(Decode(sample, m));
    const auto read = test::ReadByExpat(sample);
    ASSERT_TRUE(read);
    for (std::size_t k = 0; k < 6; ++k) {
      const std::string axis = std::to_string(k + 1);
      EXPECT_EQ((*m.axes_measured)[k], std::stod(read->at("AIPos/A" + axis)));
      EXPECT_EQ((*m.external_axes)[k], std::stod(read->at("EIPos/E" + axis)));
      EXPECT_EQ((*m.pose_measured)[k], std::stod(read->at("RIst/" + std::string(1, "XYZABC"[k]))));
    }
    EXPECT_EQ(m.ipoc, std::stoull(read->at("IPOC")));
  }
}

TEST(RsiCodec, ReadsEveryFormThatXmlAllows) {
  using namespace std::string_view_literals;
  RsiRobotMessage m;
  for (const std::string_view text : {
           // attributes in another order, single quotes, white space, TYPE, a sign
           "\r\n <Rob TYPE='KUKA' >\n <AIPos A6=' 6 ' A5=\"5\" A4 = '4' A3='3.0e0'\tA2='+2' A1='1' />\n"
           "<IPOC> 42 </IPOC > </Rob >\n"sv,
           // elements in another order, and unknown elements
           "<?xml version=\"1.0\"?><!-- a > b --><Rob><Tech C11='1' A1='x'><AIPos "
           "A1='9'/>text</Tech><IPOC>42</IPOC><Digout o1=\"0\"/><ST_Source>44.0 &lt; 45</ST_Source><AIPos "
           "A1='1' A2='2' A3='3' A4='4' A5='5' A6='6' A7='8' B='&amp;'></AIPos><!----></Rob>"sv,
           // followed by a NUL, as C programs send it
           "<Rob Type=\"KUKA\"><AIPos A1='1' A2='2' A3='3' A4='4' A5='5' A6='6'/><IPOC>42</IPOC></Rob>\0\0"sv,
       }) {
    m = {};
    const RsiError error = Decode(text, m, static_cast<std::uint16_t>(RsiElement::kAIPos));
    ASSERT_FALSE(error) << Describe(error) << "\n" << text;
    EXPECT_EQ(m.axes_measured, (RsiAxes{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(m.ipoc, 42u);
    EXPECT_FALSE(m.delay);
  }
}

TEST(RsiCodec, ErrorNamesCodeElementAndAttribute) {
  struct Case {
    std::string text;
    RsiErrorCode code;
    RsiElement element;
    int attribute;
  };
  const std::string& good = test::kFullRobot;
  for (const Case& c : {
           Case{ReplaceFirst(good, "A4=\"0.0\" ", ""), RsiErrorCode::kMissing, RsiElement::kAIPos, 4},
           Case{ReplaceFirst(good, "<AIPos", "<AIPoss"), RsiErrorCode::kMissing, RsiElement::kAIPos, 0},
           Case{ReplaceFirst(good, "<IPOC>4208163634</IPOC>", ""), RsiErrorCode::kMissing, RsiElement::kIpoc,
                0},
           Case{ReplaceFirst(good, "4208163634", ""), RsiErrorCode::kMissing, RsiElement::kIpoc, 0},
           Case{ReplaceFirst(good, "4208163634", "-1"), RsiErrorCode::kNumber, RsiElement::kIpoc, 0},
           Case{ReplaceFirst(good, "4208163634", "99999999999999999999"), RsiErrorCode::kNumber,
                RsiElement::kIpoc, 0},
           Case{ReplaceFirst(good, "4208163634", "42.0"), RsiErrorCode::kNumber, RsiElement::kIpoc, 0},
           Case{ReplaceFirst(good, "-90.25", "-90,25"), RsiErrorCode::kNumber, RsiElement::kAIPos, 2},
           Case{ReplaceFirst(good, "-90.25", "nan"), RsiErrorCode::kNumber, RsiElement::kAIPos, 2},
           Case{ReplaceFirst(good, "-90.25", "1e999"), RsiErrorCode::kNumber, RsiElement::kAIPos, 2},
           Case{ReplaceFirst(good, "-90.25", "-1e7"), RsiErrorCode::kNumber, RsiElement::kAIPos, 2},
           Case{ReplaceFirst(good, "-90.25", "0x10"), RsiErrorCode::kNumber, RsiElement::kAIPos, 2},
           Case{ReplaceFirst(good, "-90.25", ""), RsiErrorCode::kNumber, RsiElement::kAIPos, 2},
           Case{ReplaceFirst(good, "D=\"3\"", "D=\"-3\""), RsiErrorCode::kNumber, RsiElement::kDelay, 1},
           Case{ReplaceFirst(good, "D=\"3\"", ""), RsiErrorCode::kMissing, RsiElement::kDelay, 1},
           Case{ReplaceFirst(good, "A4=\"0.0\"", "A3=\"0.0\""), RsiErrorCode::kRepeated, RsiElement::kAIPos,
                3},
           Case{ReplaceFirst(good, "<Delay D=\"3\"/>", "<Delay D=\"3\"/><Delay D=\"3\"/>"),
                RsiErrorCode::kRepeated, RsiElement::kDelay, 0},
           Case{ReplaceFirst(good, "\"KUKA\"", "\"ABB\""), RsiErrorCode::kWrongRoot, RsiElement::kNone, 0},
           Case{"<Sen Type=\"ImFree\"></Sen>", RsiErrorCode::kWrongRoot, RsiElement::kNone, 0},
           Case{good + good, RsiErrorCode::kMalformed, RsiElement::kNone, 0},
           Case{good + "x", RsiErrorCode::kMalformed, RsiElement::kNone, 0},
           Case{"<!DOCTYPE Rob>" + good, RsiErrorCode::kMalformed, RsiElement::kNone, 0},
           Case{ReplaceFirst(good, "</Rob>", "</Rub>"), RsiErrorCode::kMalformed, RsiElement::kNone, 0},
           Case{ReplaceFirst(good, "A=\"-180.0\"", "A=-180.0"), RsiErrorCode::kMalformed, RsiElement::kRIst,
                0},
           Case{ReplaceFirst(good, "\" Y=", "\"Y="), RsiErrorCode::kMalformed, RsiElement::kRIst, 0},
           Case{"", RsiErrorCode::kMalformed, RsiElement::kNone, 0},
           Case{"<Rob><a><b><c><d><e><f><g><h></h></g></f></e></d></c></b></a><IPOC>1</IPOC></Rob>",
                RsiErrorCode::kMalformed, RsiElement::kNone, 0},
       }) {
    RsiRobotMessage m;
    const RsiError error = Decode(c.text, m, static_cast<std::uint16_t>(RsiElement::kAIPos));
    EXPECT_EQ(error.code, c.code) << Describe(error) << "\n" << c.text;
    EXPECT_EQ(error.element, c.element) << Describe(error) << "\n" << c.text;
    EXPECT_EQ(error.attribute, c.attribute) << Describe(error) << "\n" << c.text;
    EXPECT_EQ(m.ipoc, 0u) << "unchanged";
  }
  RsiRobotMessage m;
  EXPECT_EQ(Describe(Decode(ReplaceFirst(good, "A4=\"0.0\" ", ""), m)), "AIPos: A4 is missing (byte 221)");
  EXPECT_EQ(Decode(std::string(kRsiMaxDatagram + 1, ' '), m).code, RsiErrorCode::kTooLong);
  EXPECT_FALSE(Decode(good + std::string(kRsiMaxDatagram - good.size(), ' '), m));
}

TEST(RsiCodec, RefusesAMessageCutOffAtAnyByte) {
  for (const std::string& sample : {test::kFullRobot, test::kShortRobot})
    for (std::size_t size = 0; size < sample.size(); ++size) {
      RsiRobotMessage m;
      ASSERT_TRUE(Decode(std::string_view(sample).substr(0, size), m)) << "at " << size;
    }
}

// Sets C++'s global locale to a decimal comma, and C's locale too if the system has one with a comma.
TEST(RsiCodec, NumbersDoNotFollowTheLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::string c_before = std::setlocale(LC_ALL, nullptr);
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "de_DE", "fr_FR.UTF-8"})
    if (std::setlocale(LC_ALL, name) != nullptr) break;
  std::ostringstream stream;
  stream << 1.5;
  RsiRobotMessage m;
  const RsiError error = Decode(test::kFullRobot, m);
  const std::string written = Encode({.correction = {1.5}}, 4);
  std::locale::global(before);
  std::setlocale(LC_ALL, c_before.c_str());
  ASSERT_EQ(stream.str(), "1,5") << "the locale must have been another";
  ASSERT_FALSE(error) << Describe(error);
  EXPECT_EQ((*m.axes_measured)[1], -90.25);
  EXPECT_NE(written.find("A1=\"1.5000\""), std::string::npos) << written;
}

// Refused: NaN, infinity, corrections beyond ±1e6, and a number of decimals outside 0 to 9.
TEST(RsiCodec, RefusesToWriteNumbersOutOfRange) {
  std::array<std::uint8_t, 1000> buffer;
  std::size_t size = 77;
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), -1.1e6}) {
    RsiAnswer answer;
    answer.correction[5] = bad;
    EXPECT_EQ(EncodeAnswer(answer, 4, buffer, size), RsiErrorCode::kNumber);
  }
  EXPECT_EQ(EncodeAnswer({}, 10, buffer, size), RsiErrorCode::kNumber);
  EXPECT_EQ(EncodeAnswer({}, -1, buffer, size), RsiErrorCode::kNumber);
  EXPECT_EQ(size, 77u);
}

TEST(RsiCodec, NeverWritesBeyondTheBuffer) {
  const RsiAnswer answer{.layout = RsiLayout::kKroshu, .correction = {-1e6, 1e6}, .ipoc = ~std::uint64_t{0}};
  const std::string whole = Encode(answer, 9);
  for (std::size_t room = 0; room <= whole.size(); ++room) {
    std::vector<std::uint8_t> buffer(room + 8, 0xee);
    std::size_t size = 0;
    const RsiErrorCode code = EncodeAnswer(answer, 9, std::span(buffer).first(room), size);
    ASSERT_EQ(code, room < whole.size() ? RsiErrorCode::kNoSpace : RsiErrorCode::kNone);
    for (std::size_t i = room; i < buffer.size(); ++i) ASSERT_EQ(buffer[i], 0xee);
  }
}

TEST(RsiCodec, DoesNotAllocate) {
  const auto bytes = Bytes(test::kFullRobot), broken = Bytes(test::kFullRobot.substr(0, 300));
  std::array<std::uint8_t, 1000> buffer;
  std::size_t size = 0;
  RsiRobotMessage m;
  RsiErrorCode code{};
  bool refused = true, taken = false;
  rt::CheckedNoAllocScope no_alloc;
  taken = !DecodeRobot(bytes, 0, m);
  refused = static_cast<bool>(DecodeRobot(broken, 0, m));
  for (int decimals = 0; decimals <= 9; ++decimals)
    code = EncodeAnswer({.correction = {1e6, -1.0 / 3.0, 1e-300, -1e-9, 123456.789, 1e-5}}, decimals, buffer,
                        size);
  no_alloc.End();
  EXPECT_TRUE(taken && refused);
  EXPECT_EQ(code, RsiErrorCode::kNone);
}

}  // namespace
}  // namespace osteon::io
