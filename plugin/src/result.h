#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

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

/// Copies a text as one line of UTF-8 that ends with 0. A text longer than `to` is cut between two
/// characters. A line's end becomes a space; other control characters and bytes that are not UTF-8 become
/// '?'. No allocation.
void CopyText(std::span<char> to, std::string_view text) noexcept;

/// Stores a failure's text, cleaned by CopyText, for osteon_last_error() of this thread. No allocation.
/// @returns `code`
OsteonResult Fail(OsteonResult code, const char* text) noexcept;
[[nodiscard]] const char* LastError() noexcept;

/// Returns the result code of the exception that is being handled, and stores its text for
/// osteon_last_error(). Call it in a catch block.
OsteonResult FailByException() noexcept;

/// Runs the body of a function of osteon.h, and turns exceptions into result codes.
template <class Call>
OsteonResult Guarded(const Call& call) noexcept {
  try {
    call();
    return OSTEON_OK;
  } catch (...) {
    return FailByException();
  }
}

/// @throws Failure if the caller was compiled with another ABI; the text names both ABIs.
void CheckAbi(std::uint32_t abi);
/// @throws Failure in the forked child of a process that has used the library: a forked child has none of the
/// library's threads, so a call that needs them would wait for ever.
void CheckProcess();
/// @throws Failure if the pointer is null.
void CheckPointer(const void* pointer, const char* name);

}  // namespace osteon::plugin
