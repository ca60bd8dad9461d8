#pragma once

#include <string>
#include <string_view>

// Decides which requests may open the console's WebSocket.

namespace osteon::console {

/// Whether an address is this machine's own: 127.0.0.1, ::1, localhost.
[[nodiscard]] bool IsLoopback(std::string_view address);

/// The parts of a request to open that access depends on. None of them can be trusted: a client may send any
/// text.
struct OpenRequest {
  std::string_view host;    ///< header Host; empty: absent
  std::string_view origin;  ///< header Origin; empty: absent
  std::string_view token;   ///< value of "token=" in the query; empty: absent
};

/// Checks a request to open. A page of another origin (a site in the same browser) is always refused. A Host
/// that names neither the loopback nor `address` is refused too, because a foreign host name can be made to
/// point to this machine (DNS rebinding). If `address` is 0.0.0.0 or ::, any Host is accepted. If `token` is
/// not empty, the request must contain it.
/// @param address  address on which the server listens @returns the reason of a refusal; empty: accepted
[[nodiscard]] std::string CheckAccess(const OpenRequest& request, std::string_view address,
                                      std::string_view token);

/// Checks a request of a viewer with Foxglove's protocol, which can only read. Host and token are checked as
/// in CheckAccess. Accepted origins are: none (a program), Foxglove's page, the applications of Foxglove and
/// Lichtblick, and a page of this machine.
[[nodiscard]] std::string CheckViewerAccess(const OpenRequest& request, std::string_view address,
                                            std::string_view token);

/// Finds the value of a name in a query. Escapes such as %20 are not decoded, because the expected values
/// have only digits and letters.
/// @param name  including "=", e.g. "token=" @returns the value; empty: absent
[[nodiscard]] std::string_view QueryValue(std::string_view query, std::string_view name);

/// Makes a random token of 32 hexadecimal digits.
[[nodiscard]] std::string NewToken();

}  // namespace osteon::console
