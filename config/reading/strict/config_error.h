#pragma once

#include <stdexcept>
#include <string>

namespace osteon::config {

/// An error in a configuration file, as "file:line: key: found …, accepted …".
class ConfigError : public std::runtime_error {
 public:
  /// @param line  counted from 1; 0 if the error concerns the whole file: the text then has no line number
  ConfigError(const std::string& file, int line, const std::string& what);

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] int line() const { return line_; }
  /// The same error with a remark at its end.
  [[nodiscard]] ConfigError With(const std::string& remark) const;

 private:
  ConfigError(const std::string& text, const ConfigError& error);

  std::string file_;
  int line_;
};

}  // namespace osteon::config
