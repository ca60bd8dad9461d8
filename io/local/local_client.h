#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::io {

/// The paths of the sockets in LocalSocketFolders() that a server answers. Sockets of processes that are gone
/// are removed.
[[nodiscard]] std::vector<std::filesystem::path> FindLocalServers();

/// Sends a request, one line, to a local server and returns its answer. The error names the socket.
[[nodiscard]] tl::expected<std::string, std::string> AskLocalServer(const std::filesystem::path& socket,
                                                                    const std::string& request);

}  // namespace osteon::io
