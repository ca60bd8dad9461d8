#include "base/text.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace osteon::base {
namespace {

constexpr std::string_view kRangeMark = " … ";  // between the ends of a range, "1 … 4"

/// Breaks a text into lines of at most `width` columns. `first_word` returns the length of the word at the
/// beginning of a text.
template <class FirstWord>
std::string WrapWords(std::string_view text, std::size_t indent, std::size_t width, FirstWord first_word) {
  std::string wrapped;
  std::size_t column = indent;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, first_word(text));
    text.remove_prefix(std::min(word.size() + 1, text.size()));
    if (word.empty()) continue;
    const std::size_t columns = ColumnsOf(word);
    if (column > indent && column + 1 + columns > width) {
      wrapped += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (column > indent) {
      wrapped += ' ';
      ++column;
    }
    wrapped += word;
    column += columns;
  }
  return wrapped;
}

}  // namespace

std::size_t ColumnsOf(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return !IsTailByte(c); }));
}

std::string WrapText(std::string_view text, std::size_t indent, std::size_t width) {
  return WrapWords(text, indent, width, [](std::string_view rest) {
    std::size_t end = std::min(rest.find(' '), rest.size());
    // a range, "1 … 4", stays on one line
    while (rest.substr(end).starts_with(kRangeMark))
      end = std::min(rest.find(' ', end + kRangeMark.size()), rest.size());
    return end;
  });
}

std::optional<std::size_t> TerminalColumns(int descriptor) {
  if (const char* columns = std::getenv("COLUMNS"))
    if (const long value = std::strtol(columns, nullptr, 10); value > 0)
      return static_cast<std::size_t>(value);
  winsize size{};
  if (isatty(descriptor) != 0 && ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
    return size.ws_col;
  return std::nullopt;
}

std::string WrapForTerminal(const std::string& text, std::size_t indent) {
  constexpr std::size_t kMinText = 20;  // columns; a narrower text would be hard to read
  const auto columns = isatty(STDOUT_FILENO) != 0 ? TerminalColumns() : std::nullopt;
  return columns && *columns >= indent + kMinText ? WrapText(text, indent, *columns) : text;
}

std::string WrapMarkdown(std::string_view paragraph) {
  return WrapWords(paragraph, 0, 120, [](std::string_view rest) {  // `code with spaces` is one word
    bool code = false;
    const auto end = std::ranges::find_if(rest, [&code](char c) {
      code = code != (c == '`');
      return c == ' ' && !code;
    });
    return static_cast<std::size_t>(end - rest.begin());
  });
}

std::string Printable(std::string_view text) {
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string printable;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool ascii_control = (byte < 0x20 && byte != '\n') || byte == 0x7f;
    // control characters U+0080 … U+009F: in UTF-8 the byte 0xc2 and then this byte
    const bool next_control = byte >= 0x80 && byte < 0xa0 && i > 0 && text[i - 1] == '\xc2';
    if (next_control) printable.pop_back();
    if (ascii_control || next_control)
      printable += {'\\', 'x', kHex[byte >> 4], kHex[byte & 0xf]};
    else
      printable += text[i];
  }
  return printable;
}

std::string ToSentence(std::string text) {
  if (text.empty()) return text;
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text.ends_with('.') ? text : text + ".";
}

std::string Lower(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace osteon::base
