#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/validate/fitted_constants.h"
#include "studies/validate/validate.h"

// Checks the table in docs/validation.md, a committed result of `osteon validate`: its verdicts and counts
// must follow from its figures.

namespace osteon::studies {
namespace {

std::string Document() {
  std::ifstream file(std::string(OSTEON_SOURCE_DIR) + "/docs/validation.md");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// Cells of a line of a Markdown table, trimmed.
std::vector<std::string> TableCells(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream text(line);
  std::string cell;
  std::getline(text, cell, '|');
  while (std::getline(text, cell, '|')) {
    const auto from = cell.find_first_not_of(' ');
    cells.push_back(from == std::string::npos ? ""
                                              : cell.substr(from, cell.find_last_not_of(' ') - from + 1));
  }
  return cells;
}

struct DocumentedRow {
  double simulated{0.0};
  std::string use, verdict;
};

// Columns: row, quantity, measured, spread, simulated, tool bends, layer yields, on a mount, use, verdict.
std::map<std::string, DocumentedRow> DocumentedRows() {
  std::map<std::string, DocumentedRow> rows;
  std::istringstream text(Document());
  for (std::string line; std::getline(text, line);) {
    const std::vector<std::string> cells = TableCells(line);
    if (cells.size() != 10 || FindMeasurement(cells[0]) == nullptr) continue;
    EXPECT_FALSE(rows.contains(cells[0])) << cells[0] << " stands twice";
    rows[cells[0]] = {.simulated = std::stod(cells[4]), .use = cells[8], .verdict = cells[9]};
  }
  return rows;
}

TEST(DocumentedRows, EachRowIsPresentWithTheVerdictOfItsFigures) {
  const auto documented = DocumentedRows();
  for (const Measurement& m : Measurements()) {
    const auto found = documented.find(std::string(m.id));
    ASSERT_NE(found, documented.end()) << m.id << " is not in docs/validation.md";
    EXPECT_EQ(found->second.use, NameOf(m.use)) << m.id;
    const ValidationRow row{.measurement = &m, .simulated = {.value = found->second.simulated, .how = ""}};
    EXPECT_THAT(found->second.verdict, testing::StartsWith(std::string(row.verdict()))) << m.id;
  }
}

// Required: at least 12 judged rows, at least 8 of them within the measured spread, each of these with a
// source and not fitted.
TEST(DocumentedRows, AtLeastTwelveAreJudgedEightWithinAndCountsAreDocumented) {
  std::vector<ValidationRow> rows;
  for (const auto& [id, documented] : DocumentedRows())
    rows.push_back(
        {.measurement = FindMeasurement(id), .simulated = {.value = documented.simulated, .how = ""}});
  const ValidationCounts counts = CountRows(rows);
  EXPECT_GE(counts.judged, 12u);
  EXPECT_GE(counts.within, 8u);
  for (const ValidationRow& row : rows) {
    if (row.verdict() != "within") continue;
    EXPECT_FALSE(row.measurement->source.empty()) << row.measurement->id;
    for (const FittedConstant& fitted : FittedConstants())
      EXPECT_EQ(std::ranges::count(fitted.fitted_to, row.measurement->id), 0)
          << fitted.name() << " was fitted to " << row.measurement->id << ", which is said to lie within";
  }
  EXPECT_THAT(Document(), testing::HasSubstr("`" + KindsText(counts) + "`"));
}

}  // namespace
}  // namespace osteon::studies
