#pragma once

#include <string>
#include <string_view>

// Who may open the console's WebSocket.

namespace osteon::console {

/// Whether an address is this machine's own: 127.0.0.1, ::1, localhost.
[[nodiscard]] bool IsLoopback(std::string_view address);

/// What a request to open says of itself. Hostile: the headers are a stranger's.
struct OpenRequest {
  std::string_view host;    ///< header Host; empty: absent
  std::string_view origin;  ///< header Origin; empty: absent
  std::string_view token;   ///< of the query; empty: absent
};

/// Checks a request to open. A page of another origin (a site in the same browser) is refused always, and so
/// is a Host that names neither the loopback nor `address` (a name that was bent to this machine). Where
/// `token` is not empty, the request must have it.
/// @param address  that the server listens on  @returns why it is refused; empty: accepted
[[nodiscard]] std::string CheckAccess(const OpenRequest& request, std::string_view address,
                                      std::string_view token);

/// The same for a viewer of Foxglove's protocol, which may only look: besides a program without an origin,
/// the viewers themselves are accepted (Foxglove's page and application, Lichtblick's application, a page of
/// this machine).
[[nodiscard]] std::string CheckViewerAccess(const OpenRequest& request, std::string_view address,
                                            std::string_view token);

/// Value of a name in a query; what is asked for has digits and letters alone, so nothing is decoded.
/// @param name  with its "="  @returns empty: absent
[[nodiscard]] std::string_view QueryValue(std::string_view query, std::string_view name);

/// A random token of 32 hexadecimal digits.
[[nodiscard]] std::string NewToken();

}  // namespace osteon::console
