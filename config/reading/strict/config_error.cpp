#include "config/reading/strict/config_error.h"

#include <fmt/format.h>

namespace osteon::config {

ConfigError::ConfigError(const std::string& file, int line, const std::string& what)
    : std::runtime_error(line > 0 ? fmt::format("{}:{}: {}", file, line, what)
                                  : fmt::format("{}: {}", file, what)),
      file_(file),
      line_(line) {}

ConfigError::ConfigError(const std::string& text, const ConfigError& error)
    : std::runtime_error(text), file_(error.file_), line_(error.line_) {}

ConfigError ConfigError::With(const std::string& remark) const {
  return {std::string(what()) + remark, *this};
}

}  // namespace osteon::config
