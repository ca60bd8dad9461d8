#include "base/utf8.h"

#include <gtest/gtest.h>

namespace osteon::base {
namespace {

// Tests the sequences in table 3-7 of the Unicode Standard: at the limits of each row and just beyond them.
TEST(Utf8, FindsTheLengthOfEachValidSequence) {
  const std::pair<const char*, std::size_t> kSequences[] = {
      {"\x7f", 1},         {"\xc2\x80", 2},     {"\xdf\xbf", 2},         {"\xe0\xa0\x80", 3},
      {"\xed\x9f\xbf", 3}, {"\xef\xbf\xbf", 3}, {"\xf0\x90\x80\x80", 4}, {"\xf4\x8f\xbf\xbf", 4}};
  for (const auto& [text, length] : kSequences) EXPECT_EQ(Utf8Length(text), length) << text;
  for (const char* text :
       {"\x80", "\xbf", "\xc1\xbf", "\xc2", "\xc2\x7f", "\xe0\x9f\xbf", "\xe1\x80", "\xed\xa0\x80",
        "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff"})
    EXPECT_EQ(Utf8Length(text), 0u);
}

TEST(Utf8, ReplacesInvalidBytesAndKeepsTheRest) {
  EXPECT_EQ(Utf8("K\xc3\xb6nig, \xce\xbc"), "K\xc3\xb6nig, \xce\xbc");
  EXPECT_EQ(Utf8("K\xf6nig \xb5m\n"), "K\xef\xbf\xbdnig \xef\xbf\xbdm\n");
  EXPECT_EQ(Utf8(std::string("\xe1\x80\0", 3)), std::string("\xef\xbf\xbd\xef\xbf\xbd\0", 7));
}

}  // namespace
}  // namespace osteon::base
