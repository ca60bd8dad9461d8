#include "session/setup/identified_notice.h"

#include <cstdio>

#include <fmt/format.h>

#include "config/reading/apply_identified.h"

namespace osteon::session {

void PrintIdentified(const config::CellConfig& cell, const char* command) {
  for (const std::string& line : config::IdentifiedText(cell))
    fmt::print(stderr, "osteon {}: identified: {}\n", command, line);
}

}  // namespace osteon::session
