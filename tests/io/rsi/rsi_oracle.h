#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tests/io/rsi/xml_tree.h"

// Samples of RSI's XML, and expat as a second reader of what our code reads and writes.

namespace osteon::io::test {

/// The message of a KR C4 with every internal element configured.
inline const std::string kFullRobot =
    R"(<Rob Type="KUKA"><RIst X="1180.5" Y="-20.25" Z="1290.125" A="-180.0" B="0.5" C="179.75"/>)"
    R"(<RSol X="1180.0" Y="-20.0" Z="1290.0" A="-180.0" B="0.0" C="180.0"/>)"
    R"(<AIPos A1="1.5" A2="-90.25" A3="90.125" A4="0.0" A5="89.5" A6="-0.0625"/>)"
    R"(<ASPos A1="1.25" A2="-90.5" A3="90.0" A4="0.25" A5="90.0" A6="0.0"/>)"
    R"(<EIPos E1="10.5" E2="0.0" E3="0.0" E4="0.0" E5="0.0" E6="-1.0"/>)"
    R"(<MACur A1="1.0" A2="-12.5" A3="6.25" A4="0.5" A5="-0.75" A6="0.125"/>)"
    R"(<Delay D="3"/><IPOC>4208163634</IPOC></Rob>)";

/// The newer, shorter layout of a KR C4's message: without RSol, ASPos and MACur.
inline const std::string kShortRobot =
    R"(<Rob Type="KUKA"><RIst X="1180.5" Y="-20.25" Z="1290.125" A="-180.0" B="0.5" C="179.75"/>)"
    R"(<AIPos A1="1.5" A2="-90.25" A3="90.125" A4="0.0" A5="89.5" A6="-0.0625"/>)"
    R"(<EIPos E1="0.0" E2="0.0" E3="0.0" E4="0.0" E5="0.0" E6="0.0"/>)"
    R"(<Delay D="0"/><IPOC>0000012345</IPOC></Rob>)";

inline std::vector<std::uint8_t> Bytes(std::string_view text) { return {text.begin(), text.end()}; }
inline std::string Text(std::span<const std::uint8_t> bytes) { return {bytes.begin(), bytes.end()}; }

/// Maps "element/attribute" to the value and "element" to the text, for the root and its children.
using XmlValues = std::map<std::string, std::string>;

/// The message as expat reads it; empty if it is not well-formed.
inline std::optional<XmlValues> ReadByExpat(std::string_view text) {
  XmlNode root;
  try {
    root = ParseXml(text);
  } catch (const std::runtime_error&) {
    return {};
  }
  XmlValues values;
  const auto add_values = [&values](const XmlNode& node) {
    for (const auto& [name, value] : node.attributes) values[node.name + "/" + name] = value;
    if (!node.text.empty()) values[node.name] += node.text;
  };
  add_values(root);
  for (const XmlNode& child : root.children) add_values(child);
  return values;
}

}  // namespace osteon::io::test
