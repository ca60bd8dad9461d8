#include <string>
#include <string_view>

#include "console/server/access.h"
#include "console/server/foxglove_protocol.h"
#include "tests/fuzz/targets/fuzz_input.h"

// Fuzz target: data that a Foxglove viewer sends to its server. The input is read as a message. Its first
// line is also read as the origin of a page that connects.

namespace osteon::fuzz {
namespace {

constexpr std::size_t kChannels = 8;  // number of advertised channels

// Claims that an accepted request names only advertised channels, and that an error text is short.
void ClaimRequest(std::string_view bytes) {
  const auto request = console::ParseFoxgloveRequest(bytes, kChannels);
  if (!request) {
    Claim(request.error().find("accepted") != std::string::npos, "an error says what is accepted");
    Claim(request.error().size() <= 300, "an error is short, whatever was sent");
    return;
  }
  Claim(bytes.size() <= console::kMaxFoxgloveMessage, "a long message is refused");
  if (const auto* subscribe = std::get_if<console::FoxgloveSubscribe>(&*request)) {
    Claim(subscribe->subscriptions.size() <= console::kMaxSubscriptions, "a long list is refused");
    for (const auto& each : subscribe->subscriptions)
      Claim(each.channel < kChannels, "a channel that is not advertised is refused");
  }
}

// Claims that only the viewer's own origin and local origins are admitted.
void ClaimAccess(std::string_view origin) {
  const bool open =
      console::CheckViewerAccess({.host = "127.0.0.1:8765", .origin = origin, .token = {}}, "127.0.0.1", "")
          .empty();
  Claim(!open || origin.empty() || origin == "file://" || origin == "https://app.foxglove.dev" ||
            origin.starts_with("http://localhost") || origin.starts_with("http://127.0.0.1") ||
            origin.starts_with("http://[::1]") || origin.starts_with("http://::1"),
        "no page of another origin opens");
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  osteon::fuzz::ClaimRequest(bytes);
  osteon::fuzz::ClaimAccess(bytes.substr(0, bytes.find('\n')));
  return 0;
}
