#include <algorithm>
#include <string>
#include <string_view>

#include "console/server/access.h"
#include "console/server/client_message.h"
#include "tests/fuzz/targets/fuzz_input.h"

// Fuzz target: data that a web page sends to the console's server. If the input's byte 0 is even, the rest is
// a message. If it is odd, the rest has three lines: host, origin and token of a page that connects.

namespace osteon::fuzz {
namespace {

// Claims that a message is accepted only within the size limit, and is otherwise refused with a short error.
void ClaimMessage(std::string_view bytes) {
  const auto message = console::ParseClientMessage(bytes);
  if (message) {
    Claim(bytes.size() <= console::kMaxClientMessage, "a long message is refused");
    return;
  }
  Claim(message.error().find("accepted") != std::string::npos, "an error says what is accepted");
  Claim(message.error().size() <= 300, "an error is short, whatever was sent");
}

// Removes the first line from the text. @returns that line without its line break
std::string_view TakeLine(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

// Claims that a page is admitted only with the token, from its own origin, and by a local host name.
void ClaimAccess(std::string_view text) {
  const std::string token(32, 'a');
  const std::string_view host = TakeLine(text), origin = TakeLine(text), given = TakeLine(text);
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
    osteon::fuzz::ClaimMessage(rest);
  else
    osteon::fuzz::ClaimAccess(rest);
  return 0;
}
