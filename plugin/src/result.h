#pragma once

#include <stdexcept>
#include <string>

#include "plugin/include/osteon.h"

namespace osteon::plugin {

/// A failure with the code that the caller gets.
class Failure : public std::runtime_error {
 public:
  Failure(OsteonResult code, const std::string& text) : std::runtime_error(text), code_(code) {}
  [[nodiscard]] OsteonResult code() const { return code_; }

 private:
  OsteonResult code_;
};

/// Keeps a failure's text for osteon_last_error() of this thread; longer ones are cut. No allocation.
OsteonResult Fail(OsteonResult code, const char* text) noexcept;
[[nodiscard]] const char* LastError() noexcept;

/// The code of the exception that is being handled, its text kept. Call in a catch block.
OsteonResult FailByException() noexcept;

/// Runs a function of the interface: its exceptions become codes.
template <class Call>
OsteonResult Guarded(const Call& call) noexcept {
  try {
    call();
    return OSTEON_OK;
  } catch (...) {
    return FailByException();
  }
}

/// @throws Failure where the caller's header is of another ABI; the text names both.
void CheckAbi(std::uint32_t abi);
/// @throws Failure where a pointer is null.
void CheckPointer(const void* pointer, const char* name);

}  // namespace osteon::plugin
