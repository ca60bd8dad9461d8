#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

// Plain text: columns, lines, sentences.

namespace osteon::base {

/// Whether a byte continues a UTF-8 character: every byte but a character's first has the high bits 1 and 0.
[[nodiscard]] constexpr bool IsTailByte(char c) { return (static_cast<unsigned char>(c) & 0xC0u) == 0x80u; }

/// Number of columns that a text takes on a terminal, if each of its characters takes one column.
[[nodiscard]] std::size_t ColumnsOf(std::string_view text);

/// Breaks a text into lines of at most `width` columns, between words, and not inside a range "1 … 4". The
/// first line begins at column `indent`. Each further line begins with `indent` spaces, which are part of
/// `width`. A word that does not fit into a line has a line of its own.
[[nodiscard]] std::string WrapText(std::string_view text, std::size_t indent, std::size_t width);

/// Columns of the terminal behind a file descriptor (1: standard output). $COLUMNS takes precedence if it is
/// set. Empty if the descriptor is no terminal and $COLUMNS is not set.
[[nodiscard]] std::optional<std::size_t> TerminalColumns(int descriptor = 1);

/// Wraps a text by WrapText for the terminal behind standard output. If standard output is a file or a pipe,
/// the text stays one line.
[[nodiscard]] std::string WrapForTerminal(const std::string& text, std::size_t indent);

/// Wraps a paragraph of Markdown into lines of at most 120 characters, broken at spaces outside `code`.
[[nodiscard]] std::string WrapMarkdown(std::string_view paragraph);

/// Makes a foreign text (a name, a file's content) safe for a terminal. Control characters could move the
/// cursor or change colours: each, except a line's end, becomes an escape such as "\x1b". Bytes that are not
/// UTF-8 stay.
[[nodiscard]] std::string Printable(std::string_view text);

/// Begins a text with a capital and ends it with a full stop; an empty text stays empty.
[[nodiscard]] std::string ToSentence(std::string text);

/// Returns a text with its ASCII letters in lower case.
[[nodiscard]] std::string Lower(std::string text);

}  // namespace osteon::base
