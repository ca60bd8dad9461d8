#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::io {

/// Returns the paths of those sockets in LocalSocketFolders() at which a server answers. Removes sockets of
/// processes that have ended.
[[nodiscard]] std::vector<std::filesystem::path> FindLocalServers();

/// Sends a request (one line) to a local server and returns its answer. The error names the socket.
[[nodiscard]] tl::expected<std::string, std::string> AskLocalServer(const std::filesystem::path& socket,
                                                                    const std::string& request);

}  // namespace osteon::io
