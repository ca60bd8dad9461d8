#include "plugin/src/result.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <system_error>

#include <fmt/format.h>

#include "config/reading/load_tool.h"
#include "config/reading/strict/config_error.h"

namespace osteon::plugin {
namespace {

// Plain bytes: a thread that ends has nothing to destroy, so the library can be unloaded before it does.
constexpr std::size_t kTextSize = 1024;
thread_local std::array<char, kTextSize> last_error{};

}  // namespace

OsteonResult Fail(OsteonResult code, const char* text) noexcept {
  const std::size_t length = std::min(std::strlen(text), kTextSize - 1);
  std::memcpy(last_error.data(), text, length);
  last_error[length] = '\0';
  std::replace(last_error.begin(), last_error.begin() + static_cast<std::ptrdiff_t>(length), '\n', ' ');
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

void CheckPointer(const void* pointer, const char* name) {
  if (!pointer) throw Failure(OSTEON_ERROR_ARGUMENT, fmt::format("{}: found null, accepted a pointer", name));
}

}  // namespace osteon::plugin
