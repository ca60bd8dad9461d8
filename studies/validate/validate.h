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
  std::filesystem::path json{};     ///< empty: none
  bool quick{false};                ///< coarse bones and short runs, as in the tests
  std::string command_line{};
};

/// Returns the ids that these words choose. A word is an id, or the number of a source's row, which means all
/// its ids ("9": "9-1000" and others). The error names the wrong word and what is accepted.
[[nodiscard]] tl::expected<std::vector<std::string>, std::string> ChooseRows(
    std::span<const std::string> words);

/// The judged rows of one kind.
struct KindCount {
  RowUse use{RowUse::kValidates};
  std::string_view plural;  ///< "levels"
  std::size_t judged{0}, within{0};
};

/// Numbers of rows by their outcome.
struct ValidationCounts {
  std::size_t rows{0}, judged{0}, within{0}, missed{0}, calibrates{0}, not_judged{0}, failed{0};
  std::size_t levels_and_trends{0}, levels_and_trends_within{0};  ///< judged rows of these kinds
  std::array<KindCount, 4> kinds{{{RowUse::kValidates, "levels"},
                                  {RowUse::kTrend, "trends"},
                                  {RowUse::kRange, "ranges"},
                                  {RowUse::kTolerance, "tolerances"}}};
};
[[nodiscard]] ValidationCounts CountRows(std::span<const ValidationRow> rows);

/// "within: levels 2 of 8, trends 5 of 10, ranges 2 of 5, tolerances 2 of 2"
[[nodiscard]] std::string KindsText(const ValidationCounts& counts);

/// The printed table. Each row shows its value with rigid parts, with a tool that bends, with cartilage that
/// yields, and with the bone on a mount.
[[nodiscard]] std::string ValidationTable(std::span<const ValidationRow> rows);

/// JSON object, schema osteon.validate/1. Two runs give the same text.
[[nodiscard]] std::string ValidationJson(std::span<const ValidationRow> rows,
                                         const std::string& command_line);

/// Runs `osteon validate`.
/// @returns the process's exit code: 0; 1 a row has no result, or a file could not be written; 2 a row that
/// does not exist; 130 ended by Ctrl-C, with the finished rows written. A row that misses is a result.
[[nodiscard]] int RunValidate(const ValidateOptions& options);

}  // namespace osteon::studies
