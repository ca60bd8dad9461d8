#pragma once

#include <filesystem>
#include <functional>

#include <CLI/CLI.hpp>

#include "session/run/live_views.h"

namespace osteon::app {

/// Adds `--console`: the port and address at which the page that shows the cell is served.
void AddConsoleOption(CLI::App& sub, session::ConsoleChoice& choice);
/// Adds `--tune`: the file of `osteon tune` whose recommended gains the page shows beside the cell's gains.
void AddTuneOption(CLI::App& sub, std::filesystem::path& tune);
/// Adds `--identified`: the file with the figures that `osteon identify` measured on the cell. They replace
/// those of the cell's file.
void AddIdentifiedOption(CLI::App& sub, std::filesystem::path& identified);
/// Adds `--foxglove`: the port and address to which the viewers Foxglove and Lichtblick connect.
void AddFoxgloveOption(CLI::App& sub, session::ConsoleChoice& foxglove);

/// Adds `--record-bone`: the time between two states of the carved bone in the recording.
void AddRecordBoneOption(CLI::App& sub, double& step_s);
/// Adds `--at-fault`: whether the cell, after a fault that allows a recovery, waits at rest for the recovery
/// or ends the run.
/// @param otherwise  text for the help: the behaviour without the option
void AddAtFaultOption(CLI::App& sub, const std::string& otherwise, std::function<void(bool hold)> choose);

}  // namespace osteon::app
