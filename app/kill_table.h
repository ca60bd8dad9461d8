#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "app/kill_trial.h"

namespace osteon::app {

/// `osteon failures --kill`: real processes die in full contact, in wall time.
struct KillTableOptions {
  std::filesystem::path config_root;
  int times{20};                 ///< each
  std::filesystem::path json{};  ///< empty: none
  std::string device{};          ///< part of a Vulkan device's name
};

/// One that was not to be had, or what it came to.
struct KillRun {
  KillResult result;
  std::string error{};  ///< why there was no trial; empty where there was
  [[nodiscard]] bool passed() const { return error.empty() && result.passed(); }
};

/// Runs the trials and prints a table.
/// @returns the process's exit code: 0 the arm rested each time, within every limit; 1 not so, or the file
/// could not be written; 130 ended by Ctrl-C, what was done is written.
[[nodiscard]] int RunKillTable(const KillTableOptions& options);

/// The table as it is printed: a row a victim, and below what is wrong.
[[nodiscard]] std::string KillTableText(std::span<const KillRun> runs);

/// The JSON object, schema osteon.failures/1, with no scenario and each trial in `kills`.
[[nodiscard]] std::string KillTableJson(std::span<const KillRun> runs);

}  // namespace osteon::app
