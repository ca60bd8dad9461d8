#include "base/utf8.h"

#include <gtest/gtest.h>

#include "tests/io/recording/recording_samples.h"

namespace osteon::io {
namespace {

// The sequences of the Unicode Standard, table 3-7, at the limits of each row, and just beyond.
TEST(Utf8, KnowsWhereASequenceEnds) {
  const std::pair<const char*, std::size_t> kSequences[] = {
      {"\x7f", 1},         {"\xc2\x80", 2},     {"\xdf\xbf", 2},         {"\xe0\xa0\x80", 3},
      {"\xed\x9f\xbf", 3}, {"\xef\xbf\xbf", 3}, {"\xf0\x90\x80\x80", 4}, {"\xf4\x8f\xbf\xbf", 4}};
  for (const auto& [text, length] : kSequences) EXPECT_EQ(Utf8Length(text), length) << text;
  for (const char* text :
       {"\x80", "\xbf", "\xc1\xbf", "\xc2", "\xc2\x7f", "\xe0\x9f\xbf", "\xe1\x80", "\xed\xa0\x80",
        "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff"})
    EXPECT_EQ(Utf8Length(text), 0u);
}

TEST(Utf8, ReplacesWhatIsNoneAndLeavesTheRest) {
  EXPECT_EQ(Utf8("K\xc3\xb6nig, \xce\xbc"), "K\xc3\xb6nig, \xce\xbc");
  EXPECT_EQ(Utf8("K\xf6nig \xb5m\n"), "K\xef\xbf\xbdnig \xef\xbf\xbdm\n");
  EXPECT_EQ(Utf8(std::string("\xe1\x80\0", 3)), std::string("\xef\xbf\xbd\xef\xbf\xbd\0", 7));
}

// Found by the fuzz target recording_message: libprotobuf writes such a string, but then fails to read the
// whole message. A comment in Latin-1 in a cell's file is enough.
TEST(Utf8, ARecordingOfTextInAnotherEncodingCanBeRead) {
  SessionInfo session = test::SomeSession();
  session.config_text = "# \xb5m, K\xf6nig\nradius_mm: 3\n";
  session.config.files = {{.name = "cells/K\xf6nig.yaml", .content = session.config_text}};
  session.config.cell_file = session.config.files[0].name;
  session.limits = {"\xff"};
  std::string bytes;
  Encode(session, bytes);
  SessionInfo read;
  ASSERT_EQ(Decode(bytes, read), "");
  EXPECT_EQ(read.config_text, "# \xef\xbf\xbdm, K\xef\xbf\xbdnig\nradius_mm: 3\n");
  ASSERT_EQ(read.config.files.size(), 1u);
  EXPECT_EQ(read.config.files[0].content, session.config_text) << "a file's content is kept byte by byte";
  EXPECT_EQ(read.config.files[0].name, read.config.cell_file);

  Encode(RecordedEvent{.stamp = 1, .text = "no such file: \xe4"}, bytes);
  RecordedEvent event;
  ASSERT_EQ(Decode(bytes, event), "");
  EXPECT_EQ(event.text, "no such file: \xef\xbf\xbd");
}

}  // namespace
}  // namespace osteon::io
