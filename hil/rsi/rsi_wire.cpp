#include "hil/rsi/rsi_wire.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

namespace osteon::hil {
namespace {

constexpr std::array<std::string_view, 6> kAxisNames{"A1", "A2", "A3", "A4", "A5", "A6"};
constexpr std::array<std::string_view, 6> kExternalNames{"E1", "E2", "E3", "E4", "E5", "E6"};
constexpr std::array<std::string_view, 6> kFrameNames{"X", "Y", "Z", "A", "B", "C"};

// Returns an empty XML element with six attributes, numbers with four decimals.
std::string Element(std::string_view name, const std::array<std::string_view, 6>& attributes,
                    const Six& values) {
  std::string text = fmt::format("<{}", name);
  for (std::size_t i = 0; i < 6; ++i) text += fmt::format(" {}=\"{:.4f}\"", attributes[i], values[i]);
  return text + "/>";
}

// Parses a text by position. After the first unexpected part all calls do nothing, and error() says what was
// expected at which byte.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : text_(text) {}

  // Whether the text continues with this word. Expect also consumes the word.
  [[nodiscard]] bool Is(std::string_view word) const { return text_.substr(at_).starts_with(word); }
  void Expect(std::string_view word) {
    if (!error_.empty()) return;
    if (Is(word))
      at_ += word.size();
    else
      Fail(fmt::format("'{}'", word));
  }
  template <class Number>
  void Read(Number& value) {
    if (!error_.empty()) return;
    const auto [end, failed] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (failed != std::errc{} || !std::isfinite(static_cast<double>(value))) {
      Fail("a number");
      return;
    }
    at_ = static_cast<std::size_t>(end - text_.data());
  }
  // Consumes and returns the text up to the next `stop`; does not consume `stop`.
  std::string_view Until(std::string_view stop) {
    const std::size_t end = text_.find(stop, at_);
    if (!error_.empty() || end == std::string_view::npos) {
      Fail(fmt::format("'{}' somewhere", stop));
      return {};
    }
    const std::string_view found = text_.substr(at_, end - at_);
    at_ = end;
    return found;
  }
  void Fail(const std::string& wanted) {
    if (error_.empty()) error_ = fmt::format("byte {}: expected {}", at_, wanted);
  }
  [[nodiscard]] bool AtEnd() const { return at_ == text_.size(); }
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  std::string_view text_;
  std::size_t at_{0};
  std::string error_;
};

// Reads <RKorr … /> or <AK … /> with its six numbers.
void ReadCorrection(Cursor& cursor, bool cartesian, Six& correction) {
  cursor.Expect(cartesian ? "<RKorr" : "<AK");
  for (std::size_t i = 0; i < 6; ++i) {
    cursor.Expect(fmt::format(" {}=\"", (cartesian ? kFrameNames : kAxisNames)[i]));
    cursor.Read(correction[i]);
    cursor.Expect("\"");
  }
  cursor.Expect("/>");
}

}  // namespace

std::string WriteRob(const RobMessage& m) {
  const bool full = m.format == RsiFormat::kImFree;
  std::string text = "<Rob Type=\"KUKA\">" + Element("RIst", kFrameNames, m.pose_measured);
  if (full) text += Element("RSol", kFrameNames, m.pose_set);
  text += Element("AIPos", kAxisNames, m.axes_measured);
  if (full) text += Element("ASPos", kAxisNames, m.axes_set);
  text += Element("EIPos", kExternalNames, m.external);
  if (full) text += Element("MACur", kAxisNames, m.currents);
  return text + fmt::format("<Delay D=\"{}\"/><IPOC>{}</IPOC></Rob>", m.delay, m.ipoc);
}

tl::expected<SenMessage, std::string> ReadSen(std::span<const std::uint8_t> datagram, RsiFormat format,
                                              bool cartesian) {
  Cursor cursor({reinterpret_cast<const char*>(datagram.data()), datagram.size()});
  SenMessage message;
  const auto read_ipoc = [&] {
    cursor.Expect("<IPOC>");
    cursor.Read(message.ipoc);
    cursor.Expect("</IPOC>");
  };

  if (format == RsiFormat::kKroshu) {
    int stop = 0;
    cursor.Expect("<Sen Type=\"KROSHU\"><Stop>");
    cursor.Read(stop);
    if (stop != 0 && stop != 1) cursor.Fail("0 or 1 in <Stop>");
    message.stop = stop == 1;
    cursor.Expect("</Stop>");
    ReadCorrection(cursor, cartesian, message.correction);
    read_ipoc();
  } else {
    bool corrected = false, numbered = false;
    cursor.Expect("<Sen Type=\"ImFree\">");
    while (cursor.error().empty() && !cursor.Is("</Sen>")) {
      if (cursor.Is(cartesian ? "<RKorr " : "<AK ") && !corrected) {
        ReadCorrection(cursor, cartesian, message.correction);
        corrected = true;
      } else if (cursor.Is("<IPOC>") && !numbered) {
        read_ipoc();
        numbered = true;
      } else {  // skip an unknown element, with its content
        cursor.Expect("<");
        const std::string name(cursor.Until(">"));
        cursor.Expect(">");
        if (!name.ends_with('/')) {
          const std::string end = fmt::format("</{}>", name.substr(0, name.find(' ')));
          (void)cursor.Until(end);
          cursor.Expect(end);
        }
      }
    }
    if (!corrected) cursor.Fail(cartesian ? "<RKorr> before the end" : "<AK> before the end");
    if (!numbered) cursor.Fail("<IPOC> before the end");
  }
  cursor.Expect("</Sen>");
  if (!cursor.AtEnd()) cursor.Fail("nothing more");
  if (!cursor.error().empty()) return tl::unexpected("Sen: " + cursor.error());
  return message;
}

}  // namespace osteon::hil
