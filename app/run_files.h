#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

// What a run leaves is evidence: it is not overwritten by the next one.

namespace osteon::app {

/// The page of a run's stop, from 1 on, and the table of its ticks. @param stem  of the recording's name
[[nodiscard]] std::filesystem::path StopPage(const std::filesystem::path& folder, const std::string& stem,
                                             std::size_t number);
[[nodiscard]] std::filesystem::path StopTable(const std::filesystem::path& folder, const std::string& stem,
                                              std::size_t number);

/// "2026-11-26_09-30-00", local time.
[[nodiscard]] std::string DateAndTime(std::chrono::system_clock::time_point time);

/// "run_2026-11-26_09-30-00.mcap": the name of a recording for which none was given; with "_2" and so on
/// behind the time where a run in this folder has it already.
[[nodiscard]] std::filesystem::path DatedRecording(const std::filesystem::path& folder,
                                                   std::chrono::system_clock::time_point time);

/// What a run has left under the name of its recording: STEM.mcap, STEM_stop_1.html, STEM_stop_1_ticks.csv
/// and so on, as far as they are there. What is no file (a device) is none of them.
[[nodiscard]] std::vector<std::filesystem::path> FilesOfRun(const std::filesystem::path& recording);

/// Why a run must not leave its files under this name: one of them is there. Empty where it may.
[[nodiscard]] std::string WhyNotToRecord(const std::filesystem::path& recording);

/// Removes an earlier run's files. @returns what could not be removed, and why; empty: nothing
[[nodiscard]] std::string RemoveFiles(const std::vector<std::filesystem::path>& files);

/// A folder that one process writes a run's files into, as long as the object lives.
class FolderClaim {
 public:
  /// Nothing is claimed yet.
  FolderClaim() = default;
  ~FolderClaim();
  FolderClaim(const FolderClaim&) = delete;
  FolderClaim& operator=(const FolderClaim&) = delete;

  /// A folder that is not there is claimed by nobody. Claimed twice: nothing changes.
  /// @returns an empty string, or why not: another process has it.
  [[nodiscard]] std::string Take(const std::filesystem::path& folder);

 private:
  int descriptor_{-1};
};

/// Moves what an earlier demo has left in a folder (its recording with all that is named after it,
/// summary.json, report.html) into a folder in it, "earlier_2026-11-26_09-30-00", by the time of its newest
/// file.
/// @returns that folder; empty: nothing was there. An error names the file.
[[nodiscard]] tl::expected<std::filesystem::path, std::string> KeepEarlierDemo(
    const std::filesystem::path& folder);

/// What KeepEarlierDemo would move.
[[nodiscard]] std::vector<std::filesystem::path> FilesOfDemo(const std::filesystem::path& folder);

}  // namespace osteon::app
