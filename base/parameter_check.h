#pragma once

#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>

#include "base/number_text.h"

namespace osteon::base {

/// Refuses values of a set of parameters. @throws std::invalid_argument naming the set, the parameter, the
/// value found and what is accepted. Allocates nothing unless it throws.
class ParameterCheck {
 public:
  /// @param subject  name of the set, and the separator before a parameter's name: "sensor bias "; must be a
  ///   literal
  constexpr explicit ParameterCheck(std::string_view subject) : subject_(subject) {}

  /// Accepts low <= value <= high; NaN is outside.
  void operator()(std::string_view name, double value, double low, double high) const {
    if (!(value >= low && value <= high)) Refuse(name, value, NumberText(low) + " … " + NumberText(high));
  }
  /// Accepts a finite value if `accepted` is true. @param range  text for the error that describes the
  /// accepted values
  void operator()(std::string_view name, double value, bool accepted, const char* range) const {
    if (!accepted || !std::isfinite(value)) Refuse(name, value, range);
  }

 private:
  [[noreturn]] void Refuse(std::string_view name, double value, const std::string& accepted) const {
    throw std::invalid_argument(std::string(subject_).append(name) + ": found " + NumberText(value) +
                                ", accepted " + accepted);
  }

  std::string_view subject_;
};

}  // namespace osteon::base
