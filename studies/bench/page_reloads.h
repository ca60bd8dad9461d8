#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <sys/types.h>

#include <tl/expected.hpp>

#include "base/child_process.h"

namespace osteon::studies {

/// Waits until a demo's messages name the console's port. @param err  the file of these messages
/// @returns the port; 0 if the demo has ended, on Ctrl-C, or if no port was named within a minute
[[nodiscard]] int AwaitConsolePort(base::ChildProcess& demo, const std::filesystem::path& err);

/// How a page leaves.
enum class PageEnd : std::uint8_t {
  kCloses,  ///< with the close frame that a browser sends
  kKilled,  ///< without a close frame and with unread data, as a killed browser does
};

/// The message after which a page leaves.
enum class PageStay : std::uint8_t {
  kLiveMessage,  ///< the first live message
  kMotion,       ///< the first live message of a cell whose arm moves
  kWholeBone,    ///< the message with the whole surface of the bone
};

/// Loads a console's page as a browser does: its three files, then the stream up to the message that `stay`
/// names. Then leaves the page as `end` says.
/// @param patience_s  time limit for each file and for the stream
/// @returns an error that says which part did not come.
[[nodiscard]] tl::expected<void, std::string> LoadPageAndLeave(const std::string& address, std::uint16_t port,
                                                               PageEnd end, PageStay stay, double patience_s);

/// The resources that a process holds, from /proc; zeros if the process has ended.
struct ProcessHolds {
  double resident_MB{0.0};
  int descriptors{0}, threads{0};
};
[[nodiscard]] ProcessHolds HoldsOf(pid_t process);

/// The effect of many reloads on the process that serves the page.
struct ReloadFigures {
  int loaded{0}, killed{0};           ///< number of loaded pages, and of killed pages among them
  std::vector<std::string> failed{};  ///< for each page that was not loaded, the reason
  /// The process's resources while no page is open. `before`: before the first page. `warm`: after a tenth of
  /// the pages; the last of these received the whole bone, because the surface is only computed when a page
  /// first wants it. `after`: after all pages. `warm` and `after` are measured once the resources have
  /// settled.
  ProcessHolds before, warm, after;
  double seconds{0.0};
};

/// Loads a page `reloads` times, one after the other; every third page is killed. The process must have made
/// all connections of its own before (await PageStay::kMotion), because they count as descriptors too.
/// @param goes_on  called before each page; returns false to end early
[[nodiscard]] ReloadFigures ReloadPages(const std::string& address, std::uint16_t port, pid_t process,
                                        int reloads, const std::function<bool(int done)>& goes_on);

/// Largest growth of the resident memory from a tenth of the reloads to their end that counts as flat [MB]. A
/// run's memory varies by some MB even without pages. Assumed.
inline constexpr double kFlat_MB = 16.0;
/// Whether the reloads left nothing: `after` has no more descriptors and threads than `warm`, and the memory
/// is flat.
[[nodiscard]] bool LeftNothing(const ReloadFigures& figures);

}  // namespace osteon::studies
