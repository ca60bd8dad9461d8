#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace osteon {
namespace {

const std::filesystem::path kSource = OSTEON_SOURCE_DIR;

std::string TextOf(const std::filesystem::path& file) {
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  EXPECT_FALSE(text.str().empty()) << file;
  return text.str();
}

// The C++ sources whose messages the page shows. String literals that span several lines are joined.
std::string Sources() {
  std::string text;
  for (const char* folder :
       {"console/server", "session/gains", "session/run", "session/procedure", "session/summary"})
    for (const auto& entry : std::filesystem::directory_iterator(kSource / folder))
      if (entry.path().extension() == ".cpp") text += TextOf(entry.path());
  for (const char* file : {"hil/plc/plc_logic.cpp", "hil/fri/fri_stop.cpp", "hil/fri/fri_stop.h",
                           "io/modbus/plc_client.cpp", "session/stops/stop_records.h"})
    text += TextOf(kSource / file);
  return std::regex_replace(text, std::regex("\"\\s*\n\\s*\""), "");
}

// The page finds the translation of a message by the message's English words
// (console/web/src/message_texts.ts). If the words change in the sources, the page would show the message in
// English.
TEST(GermanMessages, EachTranslatedMessageOccursInTheSources) {
  const std::string page = TextOf(kSource / "console/web/src/message_texts.ts"), sources = Sources();
  const std::regex line("\n  \\[\"([^\"]*)\",");
  int messages = 0;
  for (std::sregex_iterator found(page.begin(), page.end(), line), end; found != end; ++found) {
    ++messages;
    std::string rest = (*found)[1];
    while (!rest.empty()) {  // for each piece of text between the placeholders {}
      const std::size_t value = std::min(rest.find("{}"), rest.size());
      EXPECT_NE(sources.find(rest.substr(0, value)), std::string::npos) << rest.substr(0, value);
      rest.erase(0, value + 2);
    }
  }
  EXPECT_GT(messages, 60);
}

}  // namespace
}  // namespace osteon
