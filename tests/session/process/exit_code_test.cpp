#include "session/process/exit_code.h"

#include <filesystem>
#include <new>
#include <stdexcept>

#include <gtest/gtest.h>

#include "config/reading/strict/reader.h"

namespace osteon::session {
namespace {

TEST(ExitCode, BadInputOutOfMemoryAndInternalErrorsHaveTheirOwnCodes) {
  EXPECT_EQ(Explain(config::ConfigError("cell.yaml", 3, "max_force_N: found 900")).code, kBadInput);
  EXPECT_EQ(Explain(std::invalid_argument("read_every_ms: found 0, accepted 1 … 100")).code, kBadInput);
  EXPECT_EQ(Explain(std::filesystem::filesystem_error("cannot open", "/nowhere", {})).code, kBadInput);
  EXPECT_EQ(Explain(std::invalid_argument("as it is")).text, "as it is");

  const Failure memory = Explain(std::bad_alloc());
  EXPECT_EQ(memory.code, 71);
  EXPECT_EQ(memory.text.rfind("out of memory", 0), 0u) << memory.text;

  for (const Failure& failure :
       {Explain(std::logic_error("the order of calls")), Explain(std::runtime_error("x")),
        Explain(std::out_of_range("vector::at"))}) {
    EXPECT_EQ(failure.code, 70);
    EXPECT_EQ(failure.text.rfind("internal error: ", 0), 0u) << failure.text;
  }
}

}  // namespace
}  // namespace osteon::session
