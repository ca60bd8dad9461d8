#pragma once

#include <filesystem>
#include <string>

namespace osteon::session {

/// The options of `osteon pause`, `resume`, `recover`, `stop` and `status`.
struct AskOptions {
  std::string request;           ///< "pause", "resume", "recover", "stop", "status"
  int pid{0};                    ///< process id of the run, needed if there are several runs; 0: the only run
  std::filesystem::path json{};  ///< file for the answer; empty: none
};

/// The options of `osteon tell`.
struct TellOptions {
  std::string session;           ///< folder of the session, or the cell's name
  std::string request;           ///< "next", "tool 46", "undo", "pause", …
  std::filesystem::path json{};  ///< file for the answer; empty: none
};

/// Runs `osteon tell`: sends the request to the cell that runs this session.
/// @returns the process's exit code: 0 done; 1 refused, or no cell runs this session; 2 several cells run it.
[[nodiscard]] int RunTell(const TellOptions& options);

/// Runs `osteon pause`, `resume`, `recover`, `stop`, `status`: sends the request to the cell that runs on
/// this machine, under this user.
/// @returns the process's exit code: 0 done; 1 refused, or no cell runs; 2 several cells run and no process
/// id was given.
[[nodiscard]] int RunAsk(const AskOptions& options);

}  // namespace osteon::session
