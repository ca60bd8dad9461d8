#pragma once

#include <string>

#include "plugin/godot/src/godot_values.h"
#include "plugin/include/osteon.h"

namespace osteon::godot {

/// The base of a class whose methods can fail. It stores the text of the last call's error, for last_error().
class ErrorKeeper {
 public:
  ErrorKeeper(const ErrorKeeper&) = delete;
  ErrorKeeper& operator=(const ErrorKeeper&) = delete;

  Value LastError(const Arguments& /*arguments*/) { return ErrorText(); }

  /// Stores the last call's error text; empty: the call succeeded. @returns the text
  std::string Keep(const std::string& text) { return error_ = text; }

 protected:
  /// @param closed  error text for calls before anything was opened: what is missing, and what to do
  explicit ErrorKeeper(const char* closed) : closed_(closed) {}
  virtual ~ErrorKeeper() = default;

  /// Stores what is wrong with a call's arguments. @param mismatch  the error; empty: none  @returns whether
  /// there is none
  bool Succeeds(const std::string& mismatch) { return Keep(mismatch).empty(); }
  /// Stores the error text of a call of a function of osteon.h. @returns whether that call succeeded
  bool Succeeds(OsteonResult result) {
    if (result == OSTEON_OK)
      error_.clear();
    else if (!HasOpened())
      error_ = closed_;
    else
      error_ = osteon_last_error();
    return result == OSTEON_OK;
  }
  /// The last call's error text as a Godot value; empty if the call succeeded.
  [[nodiscard]] Value ErrorText() const { return Value(error_); }

 private:
  [[nodiscard]] virtual bool HasOpened() const = 0;

  const char* closed_;
  std::string error_;
};

}  // namespace osteon::godot
