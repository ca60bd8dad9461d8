#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "io/rsi/codec.h"

namespace osteon::io {
namespace {

constexpr std::string_view kAxisNumbers = "123456", kFrameNames = "XYZABC";

// Writes text into a buffer; full() tells whether the buffer was too small for all of it.
class Writer {
 public:
  explicit Writer(std::span<std::uint8_t> buffer) OSTEON_RT : begin_(reinterpret_cast<char*>(buffer.data())),
                                                              end_(begin_ + buffer.size()),
                                                              at_(begin_) {}

  void Text(std::string_view text) OSTEON_RT {
    if (static_cast<std::size_t>(end_ - at_) < text.size()) {
      full_ = true;
      return;
    }
    at_ = std::copy(text.begin(), text.end(), at_);
  }

  // Writes a number with `decimals` decimals, without an exponent, and zero without a minus.
  void Number(double value, int decimals) OSTEON_RT {
    std::array<char, 32> digits;  // |value| <= 1e6, at most 9 decimals
    const auto end =
        std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals)
            .ptr;
    std::string_view text(digits.data(), static_cast<std::size_t>(end - digits.data()));
    if (text.starts_with('-') && text.find_first_not_of("-0.") == std::string_view::npos)
      text.remove_prefix(1);
    Text(text);
  }

  // Writes an integer, filled with leading zeros up to min_digits.
  void Integer(std::uint64_t value, std::size_t min_digits) OSTEON_RT {
    std::array<char, 20> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    const auto size = static_cast<std::size_t>(end - digits.data());
    for (std::size_t i = size; i < std::min<std::size_t>(min_digits, digits.size()); ++i) Text("0");
    Text({digits.data(), size});
  }

  [[nodiscard]] bool full() const OSTEON_RT { return full_; }
  [[nodiscard]] std::size_t size() const OSTEON_RT { return static_cast<std::size_t>(at_ - begin_); }

 private:
  char *begin_, *end_, *at_;
  bool full_{false};  // some text did not fit into the buffer
};

}  // namespace

RsiErrorCode EncodeAnswer(const RsiAnswer& answer, int decimals, std::span<std::uint8_t> buffer,
                          std::size_t& size) OSTEON_RT {
  if (decimals < 0 || decimals > 9) return RsiErrorCode::kNumber;
  for (const double value : answer.correction)
    if (!(std::abs(value) <= kRsiMaxValue)) return RsiErrorCode::kNumber;

  Writer writer(buffer);
  if (answer.layout == RsiLayout::kImFree) {
    writer.Text("<Sen Type=\"ImFree\">");
  } else {
    writer.Text("<Sen Type=\"KROSHU\"><Stop>");
    writer.Text(answer.stop ? "1" : "0");
    writer.Text("</Stop>");
  }
  const bool axes = answer.kind == RsiCorrection::kAxes;
  writer.Text(axes ? "<AK" : "<RKorr");
  for (std::size_t i = 0; i < answer.correction.size(); ++i) {
    writer.Text(axes ? " A" : " ");
    writer.Text((axes ? kAxisNumbers : kFrameNames).substr(i, 1));
    writer.Text("=\"");
    writer.Number(answer.correction[i], decimals);
    writer.Text("\"");
  }
  writer.Text("/><IPOC>");
  writer.Integer(answer.ipoc, answer.ipoc_digits);
  writer.Text("</IPOC></Sen>");
  if (writer.full()) return RsiErrorCode::kNoSpace;
  size = writer.size();
  return RsiErrorCode::kNone;
}

double RsiRounded(double value, int decimals) OSTEON_RT {
  // Write the number as text and read it back, so that the result equals the number that the controller
  // reads, to the last bit.
  std::array<char, 32> digits;
  if (!(std::abs(value) <= kRsiMaxValue) || decimals < 0 || decimals > 9) return value;
  const auto end =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals)
          .ptr;
  double rounded = 0.0;
  std::from_chars(digits.data(), end, rounded);
  return rounded;
}

}  // namespace osteon::io
