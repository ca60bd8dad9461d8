#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "studies/validate/validation_rows.h"

namespace osteon::studies {

/// Options of `osteon validate`.
struct ValidateOptions {
  std::filesystem::path config_root;
  std::vector<std::string> rows{};  ///< ids, or numbers of the source's rows; empty: all
  std::filesystem::path out{};      ///< folder for validate.html and validate.svg; empty: none
  std::filesystem::path json{};     ///< file for the JSON; empty: none
  bool quick{false};                ///< coarse bones and short runs, as in the tests
  std::string command_line{};
};

/// Returns the ids of the rows that these words select. A word is a row's id, or a number of the source,
/// which selects all ids that begin with it ("9" selects "9-1000" and others). The error names the wrong word
/// and the accepted words.
[[nodiscard]] tl::expected<std::vector<std::string>, std::string> ChooseRows(
    std::span<const std::string> words);

/// Number of judged rows of one kind, and number of those within their range.
struct KindCount {
  RowUse use{RowUse::kValidates};
  std::string_view plural;  ///< "levels"
  std::size_t judged{0}, within{0};
};

/// Numbers of rows by their outcome.
struct ValidationCounts {
  std::size_t rows{0}, judged{0}, within{0}, missed{0}, calibrates{0}, not_judged{0}, failed{0};
  /// judged rows of the kinds "levels" and "trends"
  std::size_t levels_and_trends{0}, levels_and_trends_within{0};
  std::array<KindCount, 4> kinds{{{RowUse::kValidates, "levels"},
                                  {RowUse::kTrend, "trends"},
                                  {RowUse::kRange, "ranges"},
                                  {RowUse::kTolerance, "tolerances"}}};
};
[[nodiscard]] ValidationCounts CountRows(std::span<const ValidationRow> rows);

/// Numbers of judged rows by kind, as text: "within: levels 2 of 8, trends 5 of 10, ranges 2 of 5, tolerances
/// 2 of 2"
[[nodiscard]] std::string KindsText(const ValidationCounts& counts);

/// The printed table. Each row shows its value with rigid parts, and the variants in which one part yields:
/// the tool, the cartilage, or the bone's mount.
[[nodiscard]] std::string ValidationTable(std::span<const ValidationRow> rows);

/// The rows as JSON object, schema osteon.validate/1. The text is reproducible.
[[nodiscard]] std::string ValidationJson(std::span<const ValidationRow> rows,
                                         const std::string& command_line);

/// Runs `osteon validate`.
/// @returns the process's exit code: 0; 1 a row has no result, or a file could not be written; 2 a row that
/// does not exist; 130 ended by Ctrl-C, with the finished rows written. A row outside its range is a result
/// and no failure.
[[nodiscard]] int RunValidate(const ValidateOptions& options);

}  // namespace osteon::studies
