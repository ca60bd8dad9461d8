#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::studies {

struct AssessResult;

/// File of a result within a session's folder, and its schema; the trend's table beside it.
inline constexpr const char* kResultName = "assess.json";
inline constexpr const char* kAssessSchema = "osteon.assess/1";
inline constexpr const char* kTrendName = "trend.csv";

/// The result of a session of the plan: another folder's assess.json, or this session's own.
struct TrendPoint {
  std::string session;  ///< NameOfFolder
  std::string began{};  ///< UTC, "2026-11-29T09:30:00Z"; empty: not known
  double score{0.0};
  bool guided{false};
  std::optional<bool> finished{};  ///< nothing: an older result does not say
};

/// Results of one plan by one rubric, with this session's, in the order in which the sessions began; by the
/// folders' names, numbers in them as numbers, where a beginning is not known.
struct Trend {
  std::vector<TrendPoint> points{};
  bool by_time{false};
};

/// A session's name for people: that of its folder, or of the one above where it is only called "session".
[[nodiscard]] std::string NameOfFolder(const std::filesystem::path& folder);

/// Finds the results beside a session: in the folders beside its own, and in their folders "session". A
/// folder that is itself called "session", as in what the demo writes, counts as the folder that it lies in.
/// @param named  further sessions' folders
/// @returns an error that names a further folder without a result of this plan and rubric.
[[nodiscard]] tl::expected<Trend, std::string> ReadTrend(const AssessResult& result,
                                                         const std::vector<std::filesystem::path>& named);

/// The trend as a table: session, began, score, guided, finished.
[[nodiscard]] std::string TrendCsv(const Trend& trend);

}  // namespace osteon::studies
