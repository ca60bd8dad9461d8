#include "console/server/access.h"

#include <algorithm>
#include <random>

#include <fmt/format.h>

namespace osteon::console {
namespace {

// Removes the port: "127.0.0.1:8470" -> "127.0.0.1"; "[::1]:8470" -> "::1".
std::string_view NameOf(std::string_view host) {
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    return end == std::string_view::npos ? host : host.substr(1, end - 1);
  }
  return host.substr(0, host.rfind(':'));
}

constexpr std::string_view kOwnAddress = "the address in the browser is not the console's own";

// Whether the header Host names this machine, or the address on which the server listens.
bool NamesThisServer(std::string_view host, std::string_view address) {
  const std::string_view name = NameOf(host);
  return IsLoopback(name) || name == address || address == "0.0.0.0" || address == "::";
}

// Compares two texts. For texts of equal length, the time does not depend on where they differ, so that a
// token cannot be guessed digit by digit.
bool SameText(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned differ = 0;
  for (std::size_t i = 0; i < a.size(); ++i) differ |= static_cast<unsigned char>(a[i] ^ b[i]);
  return differ == 0;
}

// Checks the token `found` in a request. @param token  the server's token; empty: no token is needed
// @returns the reason of a refusal; empty: accepted
std::string CheckToken(std::string_view found, std::string_view token) {
  return token.empty() || SameText(found, token) ? "" : "the token is missing or wrong";
}

}  // namespace

bool IsLoopback(std::string_view address) {
  return address == "127.0.0.1" || address == "::1" || address == "localhost";
}

std::string CheckAccess(const OpenRequest& request, std::string_view address, std::string_view token) {
  if (!NamesThisServer(request.host, address)) return std::string(kOwnAddress);
  // A browser always sends the page's origin. A program may omit it.
  if (!request.origin.empty() && request.origin != fmt::format("http://{}", request.host))
    return "a page of another origin may not open the console";
  return CheckToken(request.token, token);
}

std::string CheckViewerAccess(const OpenRequest& request, std::string_view address, std::string_view token) {
  if (!NamesThisServer(request.host, address)) return std::string(kOwnAddress);
  const std::string_view origin = request.origin;
  const bool is_application = origin.empty() || origin == "file://";
  const bool is_viewer_page = origin == "https://app.foxglove.dev" ||
                              (origin.starts_with("http://") && IsLoopback(NameOf(origin.substr(7))));
  if (!is_application && !is_viewer_page) return "a page of another origin may not open the cell's topics";
  return CheckToken(request.token, token);
}

std::string_view QueryValue(std::string_view query, std::string_view name) {
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view part = query.substr(0, end);
    if (part.starts_with(name)) return part.substr(name.size());
    query.remove_prefix(std::min(end + 1, query.size()));
  }
  return {};
}

std::string NewToken() {
  std::random_device random;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", random());
  return token;
}

}  // namespace osteon::console
