#include "console/server/access.h"

#include <random>

#include <fmt/format.h>

namespace osteon::console {
namespace {

// "127.0.0.1:8470" -> "127.0.0.1"; "[::1]:8470" -> "::1".
std::string_view NameOf(std::string_view host) {
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    return end == std::string_view::npos ? host : host.substr(1, end - 1);
  }
  return host.substr(0, host.rfind(':'));
}

// Takes the same time wherever two texts of equal length differ, so that a token cannot be guessed digit by
// digit.
bool SameText(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned differ = 0;
  for (std::size_t i = 0; i < a.size(); ++i) differ |= static_cast<unsigned char>(a[i] ^ b[i]);
  return differ == 0;
}

}  // namespace

bool IsLoopback(std::string_view address) {
  return address == "127.0.0.1" || address == "::1" || address == "localhost";
}

std::string CheckAccess(const OpenRequest& request, std::string_view address, std::string_view token) {
  const std::string_view name = NameOf(request.host);
  const bool everywhere = address == "0.0.0.0" || address == "::";
  if (!IsLoopback(name) && name != address && !everywhere)
    return "the address in the browser is not the console's own";
  // a browser always names the page's origin; a program need not
  if (!request.origin.empty() && request.origin != fmt::format("http://{}", request.host))
    return "a page of another origin may not open the console";
  if (!token.empty() && !SameText(request.token, token)) return "the token is missing or wrong";
  return "";
}

std::string NewToken() {
  std::random_device random;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", random());
  return token;
}

}  // namespace osteon::console
