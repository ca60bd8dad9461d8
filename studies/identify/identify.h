#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

namespace osteon::studies {

/// Runs that `osteon identify` can do.
struct IdentifyRuns {
  bool noise{true}, free{true}, validate{true};
  bool held{false};    ///< runs with a hand at the handle
  bool tremor{false};  ///< a run in which a hand holds the handle of the arm at rest
  bool joints{false};  ///< runs that move one joint after another, with nobody at the handle
};

/// Options of `osteon identify`.
struct IdentifyOptions {
  std::filesystem::path cell;
  bool simulated{false};  ///< moves the simulated cell, in virtual time
  bool wall_time{false};  ///< with `simulated`: in wall time, over the protocols of a real cell
  IdentifyRuns runs{};
  std::string axes{"xyz"};                           ///< axes of the tool's frame
  std::vector<double> speeds_m_per_s{0.01, 0.05};    ///< peak speeds
  std::vector<int> joints{};                         ///< 1 … 7; empty: all of the arm
  std::vector<double> joint_speeds_rad_per_s{0.15};  ///< peak speeds of a joint
  /// Recordings to estimate from; empty: the arm is moved and recorded.
  std::vector<std::filesystem::path> recordings{};
  std::vector<std::filesystem::path> validations{};
  std::filesystem::path out{
      "identify"};               ///< folder for recordings, identified.yaml, identify.json, identify.html
  std::filesystem::path json{};  ///< a second copy of identify.json; empty: none
  const std::atomic<bool>* stop{nullptr};
  int table_seeds{0};  ///< above 0: only the table of synthetic recordings is made, with this many seeds
  std::string command_line{};
};

/// Runs `osteon identify CELL`: moves the arm (or reads recordings), estimates, judges, and writes the page,
/// the figures, and, if nothing was refused, identified.yaml.
/// @returns the process's exit code: 0; 1 a result was refused, or the present gains are not stable; 2 bad
/// input.
[[nodiscard]] int RunIdentify(const IdentifyOptions& options);

}  // namespace osteon::studies
