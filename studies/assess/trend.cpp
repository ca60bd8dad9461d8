#include "studies/assess/trend.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <set>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_value.h"
#include "studies/assess/assess_result.h"

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;

// A folder of this name gets the name of the folder that contains it (NameOfFolder).
constexpr const char* kInnerFolder = "session";

// The absolute path, without links and without a slash at its end.
fs::path WholePath(const fs::path& folder) {
  const fs::path whole = fs::weakly_canonical(folder);
  return whole.has_filename() ? whole : whole.parent_path();
}

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// Reads digits from position `at` on, and moves `at` past them. Returns the digits without leading zeros.
std::string TakeNumber(const std::string& text, std::size_t& at) {
  while (at < text.size() && text[at] == '0') ++at;
  const std::size_t begin = at;
  while (at < text.size() && IsDigit(text[at])) ++at;
  return text.substr(begin, at - begin);
}

// Compares names character by character, but runs of digits as numbers: session_2 comes before session_10.
bool NaturalLess(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (IsDigit(a[i]) && IsDigit(b[j])) {
      const std::string m = TakeNumber(a, i), n = TakeNumber(b, j);
      if (m != n) return m.size() != n.size() ? m.size() < n.size() : m < n;
      continue;
    }
    if (a[i] != b[j]) return a[i] < b[j];
    ++i;
    ++j;
  }
  return a.size() - i < b.size() - j;
}

// Reads the result in a folder. The error says what was found there instead of a result of this plan and
// rubric.
tl::expected<TrendPoint, std::string> PointOf(const fs::path& folder, const AssessResult& result) {
  std::ifstream stream(folder / kResultName);
  if (!stream)
    return tl::make_unexpected(fmt::format("found no {}, accepted a session that was assessed", kResultName));
  const auto json = nlohmann::ordered_json::parse(stream, nullptr, false);
  const auto &plan = base::ValueAt(json, "plan"), &score = base::ValueAt(json, "score");
  if (base::TextAt(json, "schema") != kAssessSchema || !base::ValueAt(score, "total").is_number())
    return tl::make_unexpected(
        fmt::format("found a {} of another form, accepted {}", kResultName, kAssessSchema));
  if (const std::string found = base::TextAt(plan, "checksum"); found != result.session.file.plan_checksum)
    return tl::make_unexpected(fmt::format("found a session of another plan ({}), accepted one of {}", found,
                                           result.session.file.plan_checksum));
  if (const std::string found = base::TextAt(score, "rubric"); found != result.rubric.name)
    return tl::make_unexpected(
        fmt::format("found a score by the rubric {}, accepted one by {}", found, result.rubric.name));
  const auto& finished = base::ValueAt(json, "finished");
  return TrendPoint{.session = NameOfFolder(folder),
                    .began = base::TextAt(json, "began"),
                    .score = base::NumberAt(score, "total"),
                    .guided = base::FlagAt(json, "guided"),
                    .finished = finished.is_boolean() ? std::optional(finished.get<bool>()) : std::nullopt};
}

// The folders beside a session in which results may lie.
std::vector<fs::path> FoldersBeside(const fs::path& own) {
  std::vector<fs::path> around{own.parent_path()}, folders;
  if (own.filename() == kInnerFolder) around.push_back(own.parent_path().parent_path());
  for (const fs::path& parent : around) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(parent, error))
      for (const fs::path& folder : {entry.path(), entry.path() / kInnerFolder}) folders.push_back(folder);
  }
  return folders;
}

// A field of a CSV table, in quotes if it needs them.
std::string CsvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

}  // namespace

std::string NameOfFolder(const fs::path& folder) {
  const fs::path own = WholePath(folder);
  return own.filename() == kInnerFolder ? own.parent_path().filename().string() : own.filename().string();
}

tl::expected<Trend, std::string> ReadTrend(const AssessResult& result, const std::vector<fs::path>& named) {
  const fs::path own = WholePath(result.session.folder);
  std::set<fs::path> seen{own};  // so that no folder counts twice
  Trend trend{.points = {{.session = NameOfFolder(own),
                          .began = result.session.file.began,
                          .score = result.score.total,
                          .guided = result.guided,
                          .finished = result.unfinished.text.empty()}}};
  for (const fs::path& folder : named) {
    auto point = PointOf(folder, result);
    if (!point) return tl::make_unexpected(fmt::format("--trend {}: {}", folder.string(), point.error()));
    if (seen.insert(WholePath(folder)).second) trend.points.push_back(std::move(*point));
  }
  for (const fs::path& folder : FoldersBeside(own)) {
    auto point = PointOf(folder, result);
    if (point && seen.insert(WholePath(folder)).second) trend.points.push_back(std::move(*point));
  }
  trend.by_time = std::ranges::none_of(trend.points, [](const TrendPoint& p) { return p.began.empty(); });
  std::ranges::stable_sort(trend.points, [&](const TrendPoint& a, const TrendPoint& b) {
    if (trend.by_time && a.began != b.began) return a.began < b.began;
    return NaturalLess(a.session, b.session);
  });
  return trend;
}

std::string TrendCsv(const Trend& trend) {
  std::string text = "session,began,score,guided,finished\n";
  for (const TrendPoint& point : trend.points)
    text += fmt::format("{},{},{:.2f},{},{}\n", CsvField(point.session), point.began, point.score,
                        point.guided, point.finished ? *point.finished ? "true" : "false" : "");
  return text;
}

}  // namespace osteon::studies
