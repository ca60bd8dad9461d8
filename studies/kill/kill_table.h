#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "studies/kill/kill_trial.h"

namespace osteon::studies {

/// Options of `osteon failures --kill`: real processes are killed in full contact, in wall time.
struct KillTableOptions {
  std::filesystem::path config_root;
  int times{20};                      ///< number of trials for each victim
  std::vector<KillVictim> victims{};  ///< empty: all
  std::filesystem::path json{};       ///< empty: none
  std::string engine{"auto"};         ///< an engine that `osteon run` accepts
  std::string device{};               ///< part of a Vulkan device's name; empty: the default device
};

/// One trial: its result, or the reason why there is none.
struct KillRun {
  KillResult result;
  std::string error{};  ///< why there was no trial; empty: there was one
  [[nodiscard]] bool passed() const { return error.empty() && result.passed(); }
};

/// Runs the trials, prints a table, and writes the JSON file that the options name.
/// @returns the process's exit code. 0: the arm came to rest in each trial, within every limit. 1: a trial
/// failed,
///   or the JSON file could not be written. 130: ended by Ctrl-C, with the finished trials written.
[[nodiscard]] int RunKillTable(const KillTableOptions& options);

/// The printed table: a row per victim, and below it a line for each trial that failed or could not be run.
[[nodiscard]] std::string KillTableText(std::span<const KillRun> runs);

/// JSON object, schema osteon.failures/1: the list `scenarios` is empty, `kills` has each trial.
[[nodiscard]] std::string KillTableJson(std::span<const KillRun> runs);

}  // namespace osteon::studies
