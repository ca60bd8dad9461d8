#include "session/run/engine_token.h"

#include <fstream>

#include <fmt/format.h>

#include "io/engine/udp_engine.h"

namespace osteon::session {
namespace {

constexpr std::size_t kMinToken = 16;  // smallest length: 16 random hexadecimal digits are 64 bits

}  // namespace

tl::expected<std::string, std::string> ReadEngineToken(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string token;
  std::getline(stream, token);
  if (!stream.is_open()) return tl::make_unexpected(file.string() + ": cannot read");
  if (token.size() < kMinToken || token.size() > io::kMaxToken)
    return tl::make_unexpected(
        fmt::format("{}: found a first line of {} characters, accepted a token of {} … {}, as `openssl rand "
                    "-hex 16` prints one",
                    file.string(), token.size(), kMinToken, io::kMaxToken));
  return token;
}

}  // namespace osteon::session
