#include "app/exit_code.h"

#include <cstdio>

#include <fmt/format.h>

namespace osteon::app {

int Fail(std::string_view command, std::string_view message, int code) {
  fmt::print(stderr, "osteon {}: {}\n", command, message);
  return code;
}

}  // namespace osteon::app
