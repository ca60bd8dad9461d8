#pragma once

#include <string>
#include <string_view>

// Decides which requests may open the console's WebSocket.

namespace osteon::console {

/// Whether an address is this machine's own: 127.0.0.1, ::1, localhost.
[[nodiscard]] bool IsLoopback(std::string_view address);

/// The parts of a request to open that access depends on. They are not to be trusted: anybody may send any.
struct OpenRequest {
  std::string_view host;    ///< header Host; empty: absent
  std::string_view origin;  ///< header Origin; empty: absent
  std::string_view token;   ///< from the query; empty: absent
};

/// Checks a request to open. A page of another origin (a site in the same browser) is always refused. So is a
/// Host that names neither the loopback nor `address`, because a foreign name can be made to lead to this
/// machine (DNS rebinding); with `address` 0.0.0.0 or :: any Host is accepted. If `token` is not empty, the
/// request must have it.
/// @param address  on which the server listens  @returns the reason of a refusal; empty: accepted
[[nodiscard]] std::string CheckAccess(const OpenRequest& request, std::string_view address,
                                      std::string_view token);

/// Checks the same for a viewer of Foxglove's protocol, which may only look. A program without an origin is
/// accepted, and so are the viewers themselves: Foxglove's page and application, Lichtblick's application, a
/// page of this machine.
[[nodiscard]] std::string CheckViewerAccess(const OpenRequest& request, std::string_view address,
                                            std::string_view token);

/// Finds the value of a name in a query. Nothing is decoded: the values in use have only digits and letters.
/// @param name  with its "="  @returns the value; empty: absent
[[nodiscard]] std::string_view QueryValue(std::string_view query, std::string_view name);

/// Makes a random token of 32 hexadecimal digits.
[[nodiscard]] std::string NewToken();

}  // namespace osteon::console
