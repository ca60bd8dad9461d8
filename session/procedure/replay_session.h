#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "session/replay/replay.h"

namespace osteon::session {

/// A recording of a session, run again.
struct SessionReplay {
  std::string recording;
  ReplayResult loop;            ///< result of the servo loop, tick by tick
  std::uint64_t frames{0};      ///< number of frames cut again, each segment from its saved state
  int states{0};                ///< number of saved states that were reached again
  int different_states{0};      ///< number of those whose hash differs
  std::string first_different;  ///< "state_2.carved: found …, accepted …"; empty: none
};

/// The options of `osteon replay DIR`.
struct SessionReplayOptions {
  std::filesystem::path session;  ///< folder
  std::filesystem::path json{};   ///< file for the result; empty: none
};

/// Runs `osteon replay DIR`: runs the loop of each recording of the session again and compares it bit for
/// bit, and cuts the bone of each segment again, from the state with which the segment began.
/// @returns the process's exit code: 0 all bits are the same; 1 one differs, or something could not be run
/// again; 2 wrong input.
[[nodiscard]] int RunReplaySession(const SessionReplayOptions& options);

}  // namespace osteon::session
