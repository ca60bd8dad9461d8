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

/// Waits for the console's port in a demo's messages. @param err  file of them
/// @returns 0: the demo has ended, or none came within a minute
[[nodiscard]] int AwaitConsolePort(base::ChildProcess& demo, const std::filesystem::path& err);

/// How a page leaves.
enum class PageEnd : std::uint8_t {
  kCloses,  ///< by the close frame that a browser sends
  kKilled,  ///< without a word, what was not read included
};

/// Until when a page stays.
enum class PageStay : std::uint8_t {
  kLiveMessage,  ///< the first one
  kWholeBone,    ///< the whole surface of the bone
};

/// Loads a console's page as a browser does: its three files, then the stream as long as it stays; then it
/// leaves.
/// @param patience_s  for each of its parts
/// @returns the error says what did not come.
[[nodiscard]] tl::expected<void, std::string> LoadPageAndLeave(const std::string& address, std::uint16_t port,
                                                               PageEnd end,
                                                               PageStay stay = PageStay::kLiveMessage,
                                                               double patience_s = 20.0);

/// The resources that a process holds, from /proc; zeros where it has gone.
struct ProcessHolds {
  double resident_MB{0.0};
  int descriptors{0}, threads{0};
};
[[nodiscard]] ProcessHolds HoldsOf(pid_t process);

/// The trace that many reloads left with a process that serves the page.
struct ReloadFigures {
  int loaded{0}, killed{0};           ///< pages that were loaded; of these, killed
  std::vector<std::string> failed{};  ///< why a page was not
  /// Without a page: before the first, after a tenth of them and one that has had the whole bone, whose
  /// surface is computed for the first page that looks, and after all of them, each once it has settled.
  ProcessHolds before, warm, after;
  double seconds{0.0};
};

/// Loads a page so many times in turn, every third of which is killed.
/// @param goes_on  false: ends
[[nodiscard]] ReloadFigures ReloadPages(const std::string& address, std::uint16_t port, pid_t process,
                                        int reloads, const std::function<bool(int done)>& goes_on);

/// Growth of the resident memory from a tenth of the reloads on that counts as flat [MB]. A run's own memory
/// moves by some MB, whoever looks. Assumed.
inline constexpr double kFlat_MB = 16.0;
/// Whether nothing was left: no descriptor and no thread more, and memory that is flat.
[[nodiscard]] bool LeftNothing(const ReloadFigures& figures);

}  // namespace osteon::studies
