#include "plugin/src/result.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <new>
#include <system_error>

#include <fmt/format.h>

#include "base/utf8.h"
#include "config/reading/load_tool.h"
#include "config/reading/strict/config_error.h"

namespace osteon::plugin {
namespace {

// The text is an array of bytes, which needs no destructor. Therefore the library can be unloaded before the
// threads that called it end.
constexpr std::size_t kTextSize = 1024;
thread_local std::array<char, kTextSize> last_error{};

}  // namespace

void CopyText(std::span<char> to, std::string_view text) noexcept {
  std::size_t used = 0;
  while (!text.empty()) {
    const std::size_t length = base::Utf8Length(text), taken = std::max<std::size_t>(length, 1);
    if (used + taken >= to.size()) break;
    const auto first = static_cast<unsigned char>(text.front());
    const bool is_control = length == 1 && (first < 0x20 || first == 0x7F);
    if (length == 0 || is_control)
      to[used] = first == '\n' ? ' ' : '?';
    else
      std::memcpy(&to[used], text.data(), length);
    used += taken;
    text.remove_prefix(taken);
  }
  to[used] = '\0';
}

OsteonResult Fail(OsteonResult code, const char* text) noexcept {
  CopyText(last_error, text);
  return code;
}

const char* LastError() noexcept { return last_error.data(); }

OsteonResult FailByException() noexcept {
  try {
    throw;
  } catch (const Failure& failure) {
    return Fail(failure.code(), failure.what());
  } catch (const config::ConfigError& error) {
    return Fail(OSTEON_ERROR_FILE, error.what());
  } catch (const std::bad_alloc&) {
    return Fail(OSTEON_ERROR_MEMORY, "no memory");
  } catch (const config::ToolSizeError& error) {
    return Fail(OSTEON_ERROR_ARGUMENT, error.what());
  } catch (const std::invalid_argument& error) {
    return Fail(OSTEON_ERROR_ARGUMENT, error.what());
  } catch (const std::system_error& error) {
    return Fail(OSTEON_ERROR_MEMORY, error.what());
  } catch (const std::exception& error) {
    return Fail(OSTEON_ERROR_INTERNAL, error.what());
  } catch (...) {
    return Fail(OSTEON_ERROR_INTERNAL, "unknown exception");
  }
}

void CheckAbi(std::uint32_t abi) {
  if (abi != OSTEON_ABI)
    throw Failure(
        OSTEON_ERROR_ABI,
        fmt::format("the program was compiled with a header of ABI {}, this library ({}) has ABI {}: "
                    "compile the program again with the library's own osteon.h",
                    abi, OSTEON_VERSION, OSTEON_ABI));
}

void CheckProcess() {
  // number of the first process that called this; a forked child inherits the value
  static std::atomic<pid_t> first_user{0};
  const pid_t self = getpid();
  pid_t user = 0;
  if (!first_user.compare_exchange_strong(user, self) && user != self)
    throw Failure(OSTEON_ERROR_FORK,
                  "the process was forked: found a call in the child of a process that uses the library, "
                  "accepted in that process, or in a program that is started anew");
}

void CheckPointer(const void* pointer, const char* name) {
  if (!pointer) throw Failure(OSTEON_ERROR_ARGUMENT, fmt::format("{}: found null, accepted a pointer", name));
}

}  // namespace osteon::plugin
