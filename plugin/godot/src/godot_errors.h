#pragma once

#include <string>

#include "plugin/godot/src/godot_values.h"
#include "plugin/include/osteon.h"

namespace osteon::godot {

/// The base of a class whose methods can fail: it keeps the text of the last failure, for last_error().
class ErrorKeeper {
 public:
  ErrorKeeper(const ErrorKeeper&) = delete;
  ErrorKeeper& operator=(const ErrorKeeper&) = delete;

  Value LastError(const Arguments& /*arguments*/) { return ErrorText(); }

  /// Keeps a text; empty: the last call succeeded. @returns the text
  std::string Keep(const std::string& text) { return error_ = text; }

 protected:
  /// @param closed  error text of a call while nothing is open: what is missing, and what to do
  explicit ErrorKeeper(const char* closed) : closed_(closed) {}
  virtual ~ErrorKeeper() = default;

  /// Keeps the error in the arguments of a call. @param mismatch  empty: none  @returns whether there is none
  bool Succeeds(const std::string& mismatch) { return Keep(mismatch).empty(); }
  /// Keeps the text of the error with which a function of osteon.h failed. @returns whether it succeeded
  bool Succeeds(OsteonResult result) {
    if (result == OSTEON_OK)
      error_.clear();
    else if (!HasOpened())
      error_ = closed_;
    else
      error_ = osteon_last_error();
    return result == OSTEON_OK;
  }
  /// For Godot: empty, or what was found and what is accepted.
  [[nodiscard]] Value ErrorText() const { return Value(error_); }

 private:
  [[nodiscard]] virtual bool HasOpened() const = 0;

  const char* closed_;
  std::string error_;
};

}  // namespace osteon::godot
