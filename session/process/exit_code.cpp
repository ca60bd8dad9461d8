#include "session/process/exit_code.h"

#include <cstdio>
#include <filesystem>
#include <new>
#include <stdexcept>

#include <fmt/format.h>

#include "base/text.h"
#include "config/reading/strict/reader.h"

namespace osteon::session {

int Fail(std::string_view command, std::string_view message, int code) {
  fmt::print(stderr, "osteon {}: {}\n", command, base::Printable(message));
  return code;
}

Failure Explain(const std::exception& error) {
  if (dynamic_cast<const config::ConfigError*>(&error) ||
      dynamic_cast<const std::invalid_argument*>(&error) ||
      dynamic_cast<const std::filesystem::filesystem_error*>(&error))
    return {.code = kBadInput, .text = error.what()};
  if (dynamic_cast<const std::bad_alloc*>(&error))
    return {.code = kNoMemory,
            .text = "out of memory: this machine has too little of it, or a limit is set (ulimit -v)"};
  return {.code = kInternalError,
          .text = fmt::format("internal error: {}; nothing is wrong with the input: please report it",
                              error.what())};
}

}  // namespace osteon::session
