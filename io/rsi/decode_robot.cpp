#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "io/rsi/codec.h"
#include "io/rsi/xml_reader.h"

namespace osteon::io {
namespace {

using Event = XmlReader::Event;

// An element's name, and a letter for the names of its attributes.
struct ElementName {
  RsiElement element;
  std::string_view name;
  // 'A': A1 … A6; 'E': E1 … E6; 'X': X Y Z A B C; 'D': D alone; 0: no attributes, the element holds a text
  char prefix;
};

constexpr std::array<ElementName, 8> kElements{{
    {RsiElement::kRIst, "RIst", 'X'},
    {RsiElement::kRSol, "RSol", 'X'},
    {RsiElement::kAIPos, "AIPos", 'A'},
    {RsiElement::kASPos, "ASPos", 'A'},
    {RsiElement::kEIPos, "EIPos", 'E'},
    {RsiElement::kMACur, "MACur", 'A'},
    {RsiElement::kDelay, "Delay", 'D'},
    {RsiElement::kIpoc, "IPOC", '\0'},
}};
constexpr std::string_view kFrameNames = "XYZABC";

// Finds an element by its name. Returns null for an element that this codec does not read.
const ElementName* FindElement(std::string_view name) OSTEON_RT {
  for (const ElementName& element : kElements)
    if (element.name == name) return &element;
  return nullptr;
}

// Returns the number 1 … 6 of an attribute of the element, 0 for any other name.
int AttributeNumber(const ElementName& element, std::string_view name) OSTEON_RT {
  if (element.prefix == 'D') return name == "D" ? 1 : 0;
  if (element.prefix == 'X') {
    const std::size_t found = name.size() == 1 ? kFrameNames.find(name[0]) : std::string_view::npos;
    return found == std::string_view::npos ? 0 : static_cast<int>(found) + 1;
  }
  if (element.prefix == '\0' || name.size() != 2 || name[0] != element.prefix) return 0;
  return name[1] >= '1' && name[1] <= '6' ? name[1] - '0' : 0;
}

// Whether `a` equals `upper`, a text of upper-case letters, regardless of the case of its ASCII letters.
bool SameLetters(std::string_view a, std::string_view upper) OSTEON_RT {
  return std::equal(a.begin(), a.end(), upper.begin(), upper.end(),
                    [](char x, char y) { return (x >= 'a' && x <= 'z' ? x - 'a' + 'A' : x) == y; });
}

std::string_view Trimmed(std::string_view text) OSTEON_RT {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

// Reads a decimal number. Blanks may surround it and one plus sign may precede it. False if the text contains
// anything else, or if the number is beyond ±kRsiMaxValue.
bool ReadNumber(std::string_view text, double& value) OSTEON_RT {
  text = Trimmed(text);
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && std::abs(value) <= kRsiMaxValue;
}

// The part of one message that has been read so far.
struct Reading {
  RsiRobotMessage message;
  std::uint16_t seen{0};  // RsiElement bits of the elements read so far
  RsiError error;

  RsiError Refuse(RsiErrorCode code, std::size_t byte, const ElementName* element = nullptr,
                  int attribute = 0) OSTEON_RT {
    return {.code = code,
            .element = element != nullptr ? element->element : RsiElement::kNone,
            .attribute = static_cast<std::uint8_t>(attribute),
            .byte = static_cast<std::uint16_t>(byte)};
  }

  void StoreElement(const ElementName& element, const std::array<double, 6>& values) OSTEON_RT {
    switch (element.element) {
      case RsiElement::kRIst:
        message.pose_measured = values;
        break;
      case RsiElement::kRSol:
        message.pose_set = values;
        break;
      case RsiElement::kAIPos:
        message.axes_measured = values;
        break;
      case RsiElement::kASPos:
        message.axes_set = values;
        break;
      case RsiElement::kEIPos:
        message.external_axes = values;
        break;
      case RsiElement::kMACur:
        message.motor_currents = values;
        break;
      case RsiElement::kDelay:
        message.delay = static_cast<std::uint32_t>(values[0]);
        break;
      default:
        break;
    }
  }

  // Stores IPOC and its number of digits. False if the text is not a number of 1 … 20 digits, below 2^64.
  bool KeepIpoc(std::string_view text) OSTEON_RT {
    if (text.empty() || text.size() > 20 || text[0] < '0' || text[0] > '9') return false;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), message.ipoc);
    message.ipoc_digits = static_cast<std::uint8_t>(text.size());
    return failed == std::errc{} && end == text.data() + text.size();
  }

  RsiError ReadElement(XmlReader& reader) OSTEON_RT;
};

// Reads one child of the root. The reader has just returned the child's kOpen; afterwards it has returned its
// kClose.
RsiError Reading::ReadElement(XmlReader& reader) OSTEON_RT {
  const ElementName* element = FindElement(reader.name());
  if (element != nullptr) {
    const auto bit = static_cast<std::uint16_t>(element->element);
    if (seen & bit) return Refuse(RsiErrorCode::kRepeated, reader.at(), element);
    seen |= bit;
  }
  std::array<double, 6> values{};
  unsigned found = 0;  // bit i: attribute i + 1 was read; IPOC: bit 0 for its text
  for (;;) {
    switch (reader.Next()) {
      case Event::kAttribute: {
        const int number =
            element != nullptr && reader.depth() == 2 ? AttributeNumber(*element, reader.name()) : 0;
        if (number == 0) break;
        const unsigned bit = 1u << (number - 1);
        if (found & bit) return Refuse(RsiErrorCode::kRepeated, reader.at(), element, number);
        found |= bit;
        double& value = values[static_cast<std::size_t>(number - 1)];
        if (!ReadNumber(reader.value(), value) || (element->prefix == 'D' && value < 0.0))
          return Refuse(RsiErrorCode::kNumber, reader.at(), element, number);
        break;
      }
      case Event::kText:
        if (element == nullptr || element->element != RsiElement::kIpoc || reader.depth() != 2) break;
        if (found != 0) return Refuse(RsiErrorCode::kRepeated, reader.at(), element);
        found = 1;
        if (!KeepIpoc(reader.value())) return Refuse(RsiErrorCode::kNumber, reader.at(), element);
        break;
      case Event::kClose: {
        if (reader.depth() != 2) break;
        if (element == nullptr) return {};
        // Attributes that must be found, as bits. Attributes of EIPos are optional: a missing external axis
        // stays 0.
        const unsigned wanted = element->prefix == 'E'                           ? 0
                                : element->prefix == 'D' || element->prefix == 0 ? 1
                                                                                 : 0x3f;
        for (int i = 0; i < 6; ++i)
          if (wanted & ~found & 1u << i)
            return Refuse(RsiErrorCode::kMissing, reader.at(), element, element->prefix == 0 ? 0 : i + 1);
        StoreElement(*element, values);
        return {};
      }
      case Event::kOpen:
        break;
      case Event::kEnd:
      case Event::kError:
        return Refuse(RsiErrorCode::kMalformed, reader.at(), element);
    }
  }
}

}  // namespace

RsiError DecodeRobot(std::span<const std::uint8_t> datagram, std::uint16_t needed,
                     RsiRobotMessage& message) OSTEON_RT {
  Reading reading;
  if (datagram.size() > kRsiMaxDatagram) return reading.Refuse(RsiErrorCode::kTooLong, kRsiMaxDatagram);
  XmlReader reader({reinterpret_cast<const char*>(datagram.data()), datagram.size()});

  // the root
  if (reader.Next() != Event::kOpen) return reading.Refuse(RsiErrorCode::kMalformed, reader.at());
  if (reader.name() != "Rob") return reading.Refuse(RsiErrorCode::kWrongRoot, reader.at());
  bool has_type = false;

  for (;;) {
    switch (reader.Next()) {
      case Event::kAttribute:
        if (!SameLetters(reader.name(), "TYPE")) break;
        if (has_type) return reading.Refuse(RsiErrorCode::kRepeated, reader.at());
        has_type = true;
        if (Trimmed(reader.value()) != "KUKA") return reading.Refuse(RsiErrorCode::kWrongRoot, reader.at());
        break;
      case Event::kOpen:
        if (const RsiError error = reading.ReadElement(reader)) return error;
        break;
      case Event::kText:  // text between elements is ignored
      case Event::kClose:
        break;
      case Event::kError:
        return reading.Refuse(RsiErrorCode::kMalformed, reader.at());
      case Event::kEnd: {
        const unsigned wanted = needed | static_cast<unsigned>(RsiElement::kIpoc);
        for (const ElementName& element : kElements)
          if (wanted & ~static_cast<unsigned>(reading.seen) & static_cast<unsigned>(element.element))
            return reading.Refuse(RsiErrorCode::kMissing, datagram.size(), &element);
        message = reading.message;
        return {};
      }
    }
  }
}

std::string Describe(const RsiError& error) {
  std::string subject;
  for (const ElementName& element : kElements)
    if (element.element == error.element) subject = std::string(element.name) + ": ";
  if (error.attribute != 0) {
    for (const ElementName& element : kElements) {
      if (element.element != error.element) continue;
      const std::size_t i = error.attribute - 1u;
      if (element.prefix == 'X')
        subject += std::string(kFrameNames.substr(i, 1));
      else if (element.prefix == 'D')
        subject += "D";
      else
        subject += fmt::format("{}{}", element.prefix, error.attribute);
      subject += " ";
    }
  }
  const std::string where = fmt::format(" (byte {})", error.byte);
  switch (error.code) {
    case RsiErrorCode::kNone:
      return "none";
    case RsiErrorCode::kTooLong:
      return fmt::format("longer than {} bytes", kRsiMaxDatagram);
    case RsiErrorCode::kMalformed:
      return subject + "not well-formed XML, or cut off" + where;
    case RsiErrorCode::kWrongRoot:
      return "not a <Rob Type=\"KUKA\">" + where;
    case RsiErrorCode::kRepeated:
      return subject + "is there twice" + where;
    case RsiErrorCode::kMissing:
      return subject + "is missing" + where;
    case RsiErrorCode::kNumber:
      return subject + "is not a number of its range" + where;
    case RsiErrorCode::kNoSpace:
      return "the buffer is too small";
  }
  return "unknown";
}

}  // namespace osteon::io
