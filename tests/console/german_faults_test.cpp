#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "safety/fault.h"

namespace osteon {
namespace {

// The console's page has a German text for each fault, in console/web/src/fault_texts.ts under the fault's
// English name.
TEST(GermanFaults, EachFaultHasAGermanText) {
  const std::filesystem::path file =
      std::filesystem::path(OSTEON_SOURCE_DIR) / "console/web/src/fault_texts.ts";
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  ASSERT_FALSE(text.str().empty()) << file;
  for (int bit = 0; bit < safety::kFaultCount; ++bit) {
    const std::string name = safety::Describe(static_cast<safety::Fault>(1u << bit)).name;
    EXPECT_NE(text.str().find("\n  \"" + name + "\": [\n"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace osteon
