#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/rsi/rsi_controller.h"
#include "io/rsi/rsi_link.h"
#include "tests/io/rsi/rsi_oracle.h"
#include "tests/io/rsi/xml_tree.h"

// Tests the files that are copied to a KR's controller (config/controllers/rsi). The messages that follow
// from their Ethernet configuration must equal, byte for byte, the messages of io/rsi and of the simulated
// controller. The RSI contexts must connect each channel to the right axis.

namespace osteon::hil {
namespace {

using io::test::ReadXmlTree;
using io::test::XmlNode;
using testing::HasSubstr;

const std::filesystem::path kFiles = std::filesystem::path(OSTEON_SOURCE_DIR) / "config/controllers/rsi";

// An Ethernet configuration with its RSI contexts, and the parameters of io/rsi and of the simulated
// controller that fit it.
struct Configuration {
  std::string ethernet;
  std::vector<std::string> contexts;
  io::RsiLayout layout;
  io::RsiCorrection kind;
  RsiFormat format;
};
const std::array<Configuration, 3> kConfigurations{{
    {"OsteonEthernet.xml",
     {"OsteonContext.rsi.xml", "OsteonContext.rsix"},
     io::RsiLayout::kImFree,
     io::RsiCorrection::kAxes,
     RsiFormat::kImFree},
    {"OsteonEthernetPose.xml",
     {"OsteonContextPose.rsix"},
     io::RsiLayout::kImFree,
     io::RsiCorrection::kCartesian,
     RsiFormat::kImFree},
    {"OsteonEthernetKroshu.xml",
     {"OsteonContextKroshu.rsix"},
     io::RsiLayout::kKroshu,
     io::RsiCorrection::kAxes,
     RsiFormat::kKroshu},
}};

// The elements of an Ethernet configuration in one direction, SEND or RECEIVE.
const std::vector<XmlNode>& Elements(const XmlNode& root, const char* direction) {
  return root.At(direction).At("ELEMENTS").children;
}

// A message in which all values differ, so that an exchange of two values would be noticed.
const RobMessage kNumbers{.pose_measured = {1180.5, -20.25, 1290.125, -180.0, 0.5, 179.75},
                          .pose_set = {1180.0, -20.0, 1290.0, -179.0, 0.25, 180.0},
                          .axes_measured = {1.5, -90.25, 90.125, 0.0, 89.5, -0.0625},
                          .axes_set = {1.25, -90.5, 90.0, 0.25, 90.0, 3.0},
                          .external = {10.5, 0.0, 0.0, 0.0, 0.0, -1.0},
                          .currents = {1.0, -12.5, 6.25, 0.5, -0.75, 0.125},
                          .delay = 7,
                          .ipoc = 4'208'163'634};

// The message <Rob> that a controller with this configuration sends, by the rules of RSI: a tag DEF_name
// stands for an internal value with fixed attributes, IPOC is always the last element, and numbers have
// `precision` decimals.
std::string ExpectedRobMessage(const XmlNode& root, int precision) {
  const std::map<std::string, std::pair<const Six*, std::array<const char*, 6>>> internal{
      {"RIst", {&kNumbers.pose_measured, {"X", "Y", "Z", "A", "B", "C"}}},
      {"RSol", {&kNumbers.pose_set, {"X", "Y", "Z", "A", "B", "C"}}},
      {"AIPos", {&kNumbers.axes_measured, {"A1", "A2", "A3", "A4", "A5", "A6"}}},
      {"ASPos", {&kNumbers.axes_set, {"A1", "A2", "A3", "A4", "A5", "A6"}}},
      {"EIPos", {&kNumbers.external, {"E1", "E2", "E3", "E4", "E5", "E6"}}},
      {"MACur", {&kNumbers.currents, {"A1", "A2", "A3", "A4", "A5", "A6"}}}};
  std::string text = "<Rob Type=\"KUKA\">";
  for (const XmlNode& element : Elements(root, "SEND")) {
    EXPECT_EQ(element.Of("INDX"), "INTERNAL");
    EXPECT_TRUE(element.Of("TAG").starts_with("DEF_")) << element.Of("TAG");
    const std::string name = element.Of("TAG").substr(4);
    text += "<" + name;
    if (name == "Delay") {
      EXPECT_EQ(element.Of("TYPE"), "LONG");
      text += fmt::format(" D=\"{}\"", kNumbers.delay);
    } else {
      EXPECT_EQ(element.Of("TYPE"), "DOUBLE");
      const auto& [values, attributes] = internal.at(name);
      for (std::size_t i = 0; i < 6; ++i)
        text += fmt::format(" {}=\"{:.{}f}\"", attributes[i], (*values)[i], precision);
    }
    text += "/>";
  }
  return text + fmt::format("<IPOC>{}</IPOC></Rob>", kNumbers.ipoc);
}

// The answer <Sen> that a controller with this configuration expects: the tags of RECEIVE in their order.
// Tags with a dot are the attributes of one element.
std::string ExpectedSenMessage(const XmlNode& root, const Six& correction, bool stop, int decimals) {
  std::string text = "<Sen Type=\"" + root.At("CONFIG").At("SENTYPE").text + "\">";
  std::string open;  // name of the element that is being written
  std::size_t next = 0;
  for (const XmlNode& element : Elements(root, "RECEIVE")) {
    const std::string tag = element.Of("TAG");
    const std::size_t dot = tag.find('.');
    const std::string name = tag.substr(0, dot);
    if (!open.empty() && (dot == std::string::npos || name != open)) {
      text += "/>";
      open.clear();
    }
    if (dot == std::string::npos) {
      text += fmt::format("<{0}>{1}</{0}>", tag, stop ? 1 : 0);
      continue;
    }
    if (open.empty()) text += "<" + (open = name);
    text += fmt::format(" {}=\"{:.{}f}\"", tag.substr(dot + 1), correction.at(next++), decimals);
  }
  if (!open.empty()) text += "/>";
  return text + fmt::format("<IPOC>{}</IPOC></Sen>", kNumbers.ipoc);
}

TEST(RsiControllerFiles, SendMessagesThatTheLinkReads) {
  for (const Configuration& configuration : kConfigurations) {
    SCOPED_TRACE(configuration.ethernet);
    const std::string rob = ExpectedRobMessage(ReadXmlTree(kFiles / configuration.ethernet), 4);

    RobMessage ours = kNumbers;
    ours.format = configuration.format;
    EXPECT_EQ(rob, WriteRob(ours)) << "the simulated controller's";

    io::RsiRobotMessage read;
    const auto needed = static_cast<std::uint16_t>(static_cast<unsigned>(io::RsiElement::kAIPos) |
                                                   static_cast<unsigned>(io::RsiElement::kDelay));
    const io::RsiError error = io::DecodeRobot(io::test::Bytes(rob), needed, read);
    ASSERT_FALSE(error) << Describe(error);
    EXPECT_EQ(read.axes_measured, kNumbers.axes_measured);
    EXPECT_EQ(read.pose_measured, kNumbers.pose_measured);
    EXPECT_EQ(read.external_axes, kNumbers.external);
    EXPECT_EQ(read.delay, kNumbers.delay);
    EXPECT_EQ(read.ipoc, kNumbers.ipoc);
    const bool full = configuration.layout == io::RsiLayout::kImFree;
    EXPECT_EQ(read.axes_set.has_value() && read.pose_set.has_value() && read.motor_currents.has_value(),
              full);
  }
}

TEST(RsiControllerFiles, ExpectTheLinksAnswersByteForByte) {
  const Six correction{1.5, -0.25, 0.0, 12.3456, 89.0, -4.0};
  for (const Configuration& configuration : kConfigurations) {
    SCOPED_TRACE(configuration.ethernet);
    const XmlNode root = ReadXmlTree(kFiles / configuration.ethernet);
    for (const bool stop : {false, true}) {
      std::array<std::uint8_t, io::kRsiMaxDatagram> buffer{};
      std::size_t size = 0;
      const int decimals = io::RsiDecimals(configuration.layout);
      ASSERT_EQ(io::EncodeAnswer({.layout = configuration.layout,
                                  .kind = configuration.kind,
                                  .correction = correction,
                                  .stop = stop,
                                  .ipoc = kNumbers.ipoc},
                                 decimals, buffer, size),
                io::RsiErrorCode::kNone);
      EXPECT_EQ(io::test::Text({buffer.data(), size}), ExpectedSenMessage(root, correction, stop, decimals));
    }
  }
}

TEST(RsiControllerFiles, HoldTheLastCorrectionIfTheSessionAssumesSo) {
  for (const Configuration& configuration : kConfigurations) {
    SCOPED_TRACE(configuration.ethernet);
    const XmlNode root = ReadXmlTree(kFiles / configuration.ethernet);
    int index = 0;
    for (const XmlNode& element : Elements(root, "RECEIVE")) {
      EXPECT_EQ(element.Of("INDX"), std::to_string(++index)) << "channels in the order of the text";
      const bool stop = element.Of("TAG") == "Stop";
      EXPECT_EQ(element.Of("TYPE"), stop ? "BOOL" : "DOUBLE");
      EXPECT_EQ(element.Of("HOLDON") == "1", !stop && io::RsiSessionParams{}.hold_on) << element.Of("TAG");
    }
    EXPECT_EQ(root.At("CONFIG").At("ONLYSEND").text, "FALSE");
  }
}

TEST(RsiControllerFiles, NameThePortOnWhichTheLinkListens) {
  const auto port = [](const char* file) { return ReadXmlTree(kFiles / file).At("CONFIG").At("PORT").text; };
  EXPECT_EQ(port("OsteonEthernet.xml"), std::to_string(io::RsiLinkParams{}.port));
  EXPECT_EQ(port("OsteonEthernetPose.xml"), std::to_string(io::RsiLinkParams{}.port));
  EXPECT_EQ(port("OsteonEthernetKroshu.xml"), "59152") << "the layout's own";
}

// An object of an RSI context, in the format of RSI 3 or of later versions. RSI 3 counts channels and axes
// from 1, later versions count from 0.
struct Object {
  std::map<int, int> source;  // input of the object (from 1) → channel of the Ethernet object (from 1)
  std::map<std::string, std::string> parameters;
  double Number(const std::string& name) const { return std::stod(parameters.at(name)); }
};

// The objects in a context file. The key is the object's type in capital letters, e.g. "AXISCORR".
std::map<std::string, Object> ObjectsOf(const std::string& context) {
  const bool rsi_3 = context.ends_with(".rsi.xml");
  const int base = rsi_3 ? 0 : 1;
  const XmlNode root = ReadXmlTree(kFiles / context);
  std::map<std::string, Object> objects;
  for (const XmlNode& node : (rsi_3 ? root : root.At("RsiObjects")).children) {
    std::string type = node.Of("ObjType");
    for (char& letter : type) letter = static_cast<char>(std::toupper(letter));
    Object& object = objects[type];
    for (const XmlNode& part : node.children)
      for (const XmlNode& entry : part.children)
        if (entry.name == "Input") {
          EXPECT_TRUE(entry.Of(rsi_3 ? "OutObjID" : "OutObjId").starts_with(rsi_3 ? "ETHERNET" : "Ethernet"));
          object.source[std::stoi(entry.Of("InIdx")) + base] = std::stoi(entry.Of("OutIdx")) + base;
        } else {
          object.parameters[entry.Of("Name")] = entry.Of("ParamValue");
        }
  }
  return objects;
}

TEST(RsiControllerFiles, ContextsConnectEachCorrectionToItsAxis) {
  const io::RsiSessionParams session;
  for (const Configuration& configuration : kConfigurations)
    for (const std::string& context : configuration.contexts) {
      SCOPED_TRACE(context);
      const std::vector<XmlNode> receive = Elements(ReadXmlTree(kFiles / configuration.ethernet), "RECEIVE");
      auto objects = ObjectsOf(context);
      Object& ethernet = objects["ETHERNET"];
      EXPECT_EQ(ethernet.parameters["ConfigFile"], configuration.ethernet);
      EXPECT_EQ(ethernet.Number("Timeout"), session.timeout_cycles);
      EXPECT_EQ(ethernet.Number("Precision"), 4) << "the controller's default is one decimal";

      const bool axes = configuration.kind == io::RsiCorrection::kAxes;
      Object& corrections = objects[axes ? "AXISCORR" : "POSCORR"];
      ASSERT_EQ(corrections.source.size(), 6u);
      for (int i = 1; i <= 6; ++i) {
        const std::string tag = receive.at(static_cast<std::size_t>(corrections.source.at(i)) - 1).Of("TAG");
        EXPECT_EQ(tag, axes ? fmt::format("AK.A{}", i) : fmt::format("RKorr.{}", "XYZABC"[i - 1]));
      }
      EXPECT_EQ(objects.count("STOP"), configuration.layout == io::RsiLayout::kKroshu);
      if (objects.contains("STOP")) {
        EXPECT_EQ(receive.at(static_cast<std::size_t>(objects["STOP"].source.at(1)) - 1).Of("TAG"), "Stop");
        EXPECT_EQ(objects["STOP"].Number("Mode"), 4) << "ends RSI_MOVECORR";
      }
    }
}

// A correction has three bounds, each wider than the previous one: the session limits its command, the
// monitor (AXISCORRMON) ends RSI with a message, and the correction object (AXISCORR) clips without a
// message.
TEST(RsiControllerFiles, MonitorLimitsLieBetweenTheSessionsRangeAndTheSilentLimits) {
  const io::RsiSessionParams session;
  for (const char* context : {"OsteonContext.rsi.xml", "OsteonContext.rsix", "OsteonContextKroshu.rsix"}) {
    SCOPED_TRACE(context);
    auto objects = ObjectsOf(context);
    for (int i = 1; i <= 6; ++i) {
      const double monitor = objects["AXISCORRMON"].Number(fmt::format("MaxA{}", i));
      EXPECT_GT(monitor, session.range[static_cast<std::size_t>(i) - 1]);
      EXPECT_GT(objects["AXISCORR"].Number(fmt::format("UpperLimA{}", i)), monitor);
      EXPECT_LT(objects["AXISCORR"].Number(fmt::format("LowerLimA{}", i)), -monitor);
    }
  }
  auto pose = ObjectsOf("OsteonContextPose.rsix");
  const double box = std::hypot(session.range[0], session.range[1], session.range[2]);
  EXPECT_GT(pose["POSCORRMON"].Number("MaxTrans"), box) << "a length, not an axis";
  for (const char axis : {'X', 'Y', 'Z'}) {
    EXPECT_GT(pose["POSCORR"].Number(fmt::format("UpperLim{}", axis)), pose["POSCORRMON"].Number("MaxTrans"));
    EXPECT_LT(pose["POSCORR"].Number(fmt::format("LowerLim{}", axis)),
              -pose["POSCORRMON"].Number("MaxTrans"));
  }
  EXPECT_EQ(pose["POSCORR"].Number("RefCorrSys"), 2) << "the robot's root: what RsiSession corrects about";
}

TEST(RsiControllerFiles, TheRobotProgramStartsRsiInTheSessionsMode) {
  const io::RsiSessionParams session;
  const std::string program = io::test::ReadText(kFiles / "osteon_rsi.src");
  EXPECT_THAT(program, HasSubstr("RSI_CREATE(\"OsteonContext\""));
  EXPECT_THAT(program, HasSubstr(fmt::format("RSI_ON({},{})", session.absolute ? "#ABSOLUTE" : "#RELATIVE",
                                             session.cycle_ms == 4 ? "#IPO_FAST" : "#IPO")));
  // The PC's link must listen before RSI begins. Therefore the program halts between RSI_CREATE and RSI_ON.
  EXPECT_LT(program.find("RSI_CREATE("), program.find("RSI_ON("));
  EXPECT_LT(program.rfind("\nHALT\n", program.find("RSI_ON(")), program.find("RSI_ON("));
}

}  // namespace
}  // namespace osteon::hil
