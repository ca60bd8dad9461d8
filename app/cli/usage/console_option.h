#pragma once

#include <filesystem>
#include <functional>

#include <CLI/CLI.hpp>

#include "session/run/live_views.h"

namespace osteon::app {

/// Adds `--console`: where the page that shows the cell is served.
void AddConsoleOption(CLI::App& sub, session::ConsoleChoice& choice);
/// Adds `--tune`: the result of `osteon tune` that the page shows beside the gains.
void AddTuneOption(CLI::App& sub, std::filesystem::path& tune);
/// Adds `--identified`: figures that were measured on the cell, instead of those that its file assumes.
void AddIdentifiedOption(CLI::App& sub, std::filesystem::path& identified);
/// Adds `--foxglove`: where viewers connect to.
void AddFoxgloveOption(CLI::App& sub, session::ConsoleChoice& foxglove);

/// Adds --record-bone: the carved bone's states in the recording.
void AddRecordBoneOption(CLI::App& sub, double& step_s);
/// Adds `--at-fault`: whether the cell is held at a fault that allows a recovery.
/// @param otherwise  text for the help: the behaviour without the option
void AddAtFaultOption(CLI::App& sub, const std::string& otherwise, std::function<void(bool hold)> choose);

}  // namespace osteon::app
