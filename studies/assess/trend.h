#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::studies {

struct AssessResult;

/// In a session's folder: name of the result's file, schema of that file, and name of the trend's table.
inline constexpr const char* kResultName = "assess.json";
inline constexpr const char* kAssessSchema = "osteon.assess/1";
inline constexpr const char* kTrendName = "trend.csv";

/// The result of a session of the plan: another folder's assess.json, or this session's own.
struct TrendPoint {
  std::string session;  ///< NameOfFolder
  std::string began{};  ///< UTC, "2026-11-29T09:30:00Z"; empty: not known
  double score{0.0};
  bool guided{false};
  std::optional<bool> finished{};  ///< empty: an older result does not say whether the session was finished
};

/// Results of one plan by one rubric, including this session's, in the order in which the sessions began. If
/// the start time of any session is not known, all are sorted by their folders' names instead, session_2
/// before session_10.
struct Trend {
  std::vector<TrendPoint> points{};
  bool by_time{false};  ///< true: sorted by start time; false: by the folders' names
};

/// The name of a session in pages and tables: that of its folder, or of the folder above if the folder is
/// only called "session".
[[nodiscard]] std::string NameOfFolder(const std::filesystem::path& folder);

/// Finds the results of other sessions: in the folders next to this session's folder, and in subfolders
/// "session" of these. A session's folder that is called "session", as the demo names it, is represented by
/// the folder that contains it.
/// @param named  folders of further sessions
/// @returns the trend; or an error that names one of the `named` folders that has no result of this plan and
/// rubric.
[[nodiscard]] tl::expected<Trend, std::string> ReadTrend(const AssessResult& result,
                                                         const std::vector<std::filesystem::path>& named);

/// The trend as a table: session, began, score, guided, finished.
[[nodiscard]] std::string TrendCsv(const Trend& trend);

}  // namespace osteon::studies
