#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

// The names of a run's files, and the functions that keep a later run from overwriting them, since they are
// evidence.

namespace osteon::session {

/// Path of the page of a run's stop, numbered from 1, and of the table of its ticks.
/// @param stem  the recording's file name without extension
[[nodiscard]] std::filesystem::path StopPage(const std::filesystem::path& folder, const std::string& stem,
                                             std::size_t number);
[[nodiscard]] std::filesystem::path StopTable(const std::filesystem::path& folder, const std::string& stem,
                                              std::size_t number);

/// Path of the report of `osteon run` and `osteon report`: STEM_report.html beside the recording.
[[nodiscard]] std::filesystem::path ReportPage(const std::filesystem::path& recording);

/// Formats a time as "2026-11-26_09-30-00", local time.
[[nodiscard]] std::string DateAndTime(std::chrono::system_clock::time_point time);

/// Names a recording for which no name was given, "run_2026-11-26_09-30-00.mcap"; "_2" and so on follows the
/// time if a run in this folder has the name already.
[[nodiscard]] std::filesystem::path DatedRecording(const std::filesystem::path& folder,
                                                   std::chrono::system_clock::time_point time);

/// Lists the existing files that a run has left under its recording's name: STEM.mcap, STEM_report.html,
/// STEM_stop_1.html, STEM_stop_1_ticks.csv and so on. Lists regular files only, no devices.
[[nodiscard]] std::vector<std::filesystem::path> FilesOfRun(const std::filesystem::path& recording);

/// Says why a run must not use this recording's name: files of an earlier run have the name. Empty if the run
/// may use it.
[[nodiscard]] std::string ValidateRecordingName(const std::filesystem::path& recording);

/// Removes an earlier run's files. @returns the files that could not be removed, and why; empty: none
[[nodiscard]] std::string RemoveFiles(const std::vector<std::filesystem::path>& files);

/// Reserves a folder for the files of one process's run, as long as the object lives.
class FolderClaim {
 public:
  /// Claims no folder yet.
  FolderClaim() = default;
  ~FolderClaim();
  FolderClaim(const FolderClaim&) = delete;
  FolderClaim& operator=(const FolderClaim&) = delete;

  /// Claims the folder. A folder that does not exist need not be claimed; a second claim changes nothing.
  /// @returns an empty string, or the reason for the refusal: another process has claimed the folder.
  [[nodiscard]] std::string Acquire(const std::filesystem::path& folder);

 private:
  int descriptor_{-1};
};

/// Moves files of a folder into a subfolder of it, "earlier_2026-11-26_09-30-00", named by the time of the
/// newest file.
/// @returns that subfolder; empty: there were no files. An error names the file.
[[nodiscard]] tl::expected<std::filesystem::path, std::string> KeepEarlier(
    const std::filesystem::path& folder, const std::vector<std::filesystem::path>& files);

/// Moves an earlier demo's files in the same way: the recording, the files named after it, summary.json and
/// report.html.
[[nodiscard]] tl::expected<std::filesystem::path, std::string> KeepEarlierDemo(
    const std::filesystem::path& folder);

/// Lists the files that KeepEarlierDemo would move.
[[nodiscard]] std::vector<std::filesystem::path> FilesOfDemo(const std::filesystem::path& folder);

}  // namespace osteon::session
