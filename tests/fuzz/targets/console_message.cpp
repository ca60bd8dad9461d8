#include <algorithm>
#include <string>
#include <string_view>

#include "console/server/access.h"
#include "console/server/client_message.h"
#include "tests/fuzz/targets/fuzz_input.h"

// What a page sends to the console's server: byte 0 selects the reader, the rest is a message, or host,
// origin and token as one text each, ended by a line end.

namespace osteon::fuzz {
namespace {

void ReadMessage(std::string_view bytes) {
  const auto message = console::ParseClientMessage(bytes);
  if (message) {
    Claim(bytes.size() <= console::kMaxClientMessage, "a long message is refused");
    return;
  }
  Claim(message.error().find("accepted") != std::string::npos, "an error says what is accepted");
  Claim(message.error().size() <= 300, "an error is short, whatever was sent");
}

std::string_view Line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

void Open(std::string_view text) {
  const std::string token(32, 'a');
  const std::string_view host = Line(text), origin = Line(text), given = Line(text);
  const console::OpenRequest request{.host = host, .origin = origin, .token = given};
  const bool open = console::CheckAccess(request, "127.0.0.1", token).empty();
  Claim(!open || given == token, "nobody opens without the token");
  Claim(!open || origin.empty() || origin == "http://" + std::string(host),
        "no page of another origin opens");
  Claim(!open || host.starts_with("127.0.0.1") || host.starts_with("localhost") ||
            host.starts_with("[::1]") || host == "::1" || host.starts_with("::1"),
        "no other name opens");
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] % 2 == 0)
    osteon::fuzz::ReadMessage(rest);
  else
    osteon::fuzz::Open(rest);
  return 0;
}
