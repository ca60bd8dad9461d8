#include "base/text.h"

#include <gtest/gtest.h>

#include "base/number_text.h"

namespace osteon::base {
namespace {

// A file name may contain the control sequence that clears a terminal, with ESC or in its 8-bit form. Its
// bytes must be shown as text and must not reach the terminal as control characters.
TEST(Printable, ShowsControlCharacters) {
  EXPECT_EQ(Printable("a\x1b[2Jb"), "a\\x1b[2Jb");
  EXPECT_EQ(Printable("bell\a tab\t return\r delete\x7f"), "bell\\x07 tab\\x09 return\\x0d delete\\x7f");
  EXPECT_EQ(Printable("\xc2\x9b"
                      "2J"),
            "\\x9b2J");
  EXPECT_EQ(Printable(std::string_view("\0", 1)), "\\x00");
}

TEST(Printable, LeavesOtherTexts) {
  for (const std::string_view text : {"", "two\nlines", "µm … 30°", "größer", "caf\xe9", "\xc2"})
    EXPECT_EQ(Printable(text), text);
}

TEST(NumberText, HasNoTrailingZeros) {
  EXPECT_EQ(NumberText(0.1), "0.1");
  EXPECT_EQ(NumberText(200.0), "200");
  EXPECT_EQ(NumberText(-1e-5), "-1e-05");
  EXPECT_EQ(NumberText(1.0000001), "1.0000001") << "a value just outside its range is told from the range";
}

}  // namespace
}  // namespace osteon::base
