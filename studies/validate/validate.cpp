#include "studies/validate/validate.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/phase_progress.h"
#include "base/write_text.h"
#include "report/page.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"
#include "studies/validate/fitted_constants.h"
#include "studies/validate/validate_page.h"
#include "studies/validate/validate_plot.h"

namespace osteon::studies {
namespace {

using Json = nlohmann::ordered_json;

// The number, or null if the source does not state it (NaN).
Json OrNull(double value) { return value == value ? Json(value) : Json(); }

Json RowJson(const ValidationRow& row) {
  const Measurement& m = *row.measurement;
  const bool has_result = row.error.empty();
  Json ablations = Json::array();
  for (const Ablation& ablation : row.simulated.ablations)
    ablations.push_back({{"what", ablation.what}, {"simulated", ablation.simulated}});
  const bool judged = row.verdict() == "within" || row.verdict() == "misses";
  Json compliance = Json::array();
  for (const ComplianceVariant& variant : row.simulated.compliance)
    compliance.push_back(
        {{"part", NameOf(variant.part)},
         {"simulated", variant.simulated ? Json(*variant.simulated) : Json()},
         {"within", variant.simulated && judged ? Json(m.Contains(*variant.simulated)) : Json()},
         {"error", variant.simulated ? Json() : Json(variant.error)}});
  const auto within = row.within();
  return {{"id", m.id},
          {"quantity", m.quantity},
          {"unit", m.unit},
          {"use", NameOf(m.use)},
          {"measured", m.measured},
          {"spread", {{"low", OrNull(m.low)}, {"high", OrNull(m.high)}, {"text", m.spread}}},
          {"simulated", has_result ? Json(row.simulated.value) : Json()},
          {"within", within ? Json(*within) : Json()},
          {"fitted", row.fitted() || m.use == RowUse::kCalibrates},
          {"verdict", row.verdict()},
          {"reason", row.verdict() == "misses" ? Json(row.simulated.reason) : Json()},
          {"ablations", ablations},
          {"compliance", compliance},
          {"how", row.simulated.how},
          {"constants", row.simulated.constants},
          {"source", m.source},
          {"conditions", m.conditions},
          {"leaves_out", m.leaves_out},
          {"error", has_result ? Json() : Json(row.error)}};
}

Json ConstantsJson() {
  Json constants = Json::array();
  for (const FittedConstant& c : FittedConstants())
    constants.push_back({{"constant", c.name()},
                         {"file", c.file},
                         {"value", c.value},
                         {"how", c.how},
                         {"fitted_to", c.fitted_to},
                         {"minor", c.minor},
                         {"minor_share", c.minor_share}});
  return constants;
}

// Lists the numbers of the source's rows, for the accepted words in an error.
std::string RowNumbers() {
  std::vector<std::string> numbers;
  for (const Measurement& m : Measurements()) {
    const std::string number(m.id.substr(0, m.id.find('-')));
    if (std::ranges::find(numbers, number) == numbers.end()) numbers.push_back(number);
  }
  return fmt::format("{}", fmt::join(numbers, ", "));
}

// A variant's value as text; "-" if its run had no result; empty if the row has no such variant.
std::string VariantText(const ValidationRow& row, CompliantPart part) {
  const ComplianceVariant* variant = row.simulated.With(part);
  if (variant == nullptr) return "";
  return variant->simulated ? fmt::format("{:.4g}", *variant->simulated) : "-";
}

// Writes JSON, plot and page if the options name a file or folder for them. @returns an error; empty: none
std::string WriteFiles(const ValidateOptions& options, std::span<const ValidationRow> rows) {
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, ValidationJson(rows, options.command_line));
        !written)
      return written.error();
  if (options.out.empty()) return "";
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (const auto written = base::WriteText(options.out / "validate.svg", ValidationPlot(rows)); !written)
    return written.error();
  const auto page =
      report::WritePage(ValidationPage(rows, options.command_line), options.out / "validate.html");
  return page ? "" : page.error();
}

}  // namespace

tl::expected<std::vector<std::string>, std::string> ChooseRows(std::span<const std::string> words) {
  std::vector<std::string> ids;
  for (const std::string& word : words) {
    const std::size_t before = ids.size();
    for (const Measurement& m : Measurements())
      if (m.id == word || m.id.substr(0, m.id.find('-')) == word) ids.emplace_back(m.id);
    if (ids.size() == before)
      return tl::make_unexpected(fmt::format(
          "--rows: found {}, accepted {}, or one part of them such as 9-1000", word, RowNumbers()));
  }
  return ids;
}

ValidationCounts CountRows(std::span<const ValidationRow> rows) {
  ValidationCounts counts{.rows = rows.size()};
  for (const ValidationRow& row : rows) {
    const std::string_view verdict = row.verdict();
    counts.failed += verdict == "no result";
    counts.calibrates += verdict == "calibrates";
    counts.not_judged += verdict == "not judged";
    const bool within = verdict == "within", judged = within || verdict == "misses";
    counts.within += within;
    counts.missed += judged && !within;
    counts.judged += judged;
    const RowUse use = row.measurement->use;
    if (const auto kind = std::ranges::find(counts.kinds, use, &KindCount::use); kind != counts.kinds.end()) {
      kind->judged += judged;
      kind->within += within;
    }
    if (use != RowUse::kValidates && use != RowUse::kTrend) continue;
    counts.levels_and_trends += judged;
    counts.levels_and_trends_within += within;
  }
  return counts;
}

std::string KindsText(const ValidationCounts& counts) {
  std::vector<std::string> kinds;
  for (const KindCount& kind : counts.kinds)
    kinds.push_back(fmt::format("{} {} of {}", kind.plural, kind.within, kind.judged));
  return fmt::format("within: {}", fmt::join(kinds, ", "));
}

std::string ValidationTable(std::span<const ValidationRow> rows) {
  std::size_t width = 8;
  for (const ValidationRow& row : rows) width = std::max(width, row.measurement->quantity.size());
  std::string text = fmt::format("{:<17} {:<{}} {:>9} {:>19} {:>9} {:>10} {:>12} {:>10} {:<5} {:<10} {}\n",
                                 "row", "quantity", width, "measured", "spread", "simulated", "tool bends",
                                 "layer yields", "on a mount", "unit", "use", "verdict");
  for (const ValidationRow& row : rows) {
    const Measurement& m = *row.measurement;
    // padded by characters, not bytes: "mm³" has four bytes
    std::string unit(m.unit == "1" ? "" : m.unit);
    const auto letters = std::ranges::count_if(unit, [](char c) { return (c & 0xC0) != 0x80; });
    unit.append(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, 5 - letters)), ' ');
    std::string quantity(m.quantity);
    const auto shown = std::ranges::count_if(quantity, [](char c) { return (c & 0xC0) != 0x80; });
    quantity.append(width - static_cast<std::size_t>(shown), ' ');
    text +=
        fmt::format("{:<17} {} {:>9.4g} {:>19} {:>9} {:>10} {:>12} {:>10} {} {:<10} {}\n", m.id, quantity,
                    m.measured, m.judged() ? fmt::format("{:.4g} to {:.4g}", m.low, m.high) : "not stated",
                    row.error.empty() ? fmt::format("{:.4g}", row.simulated.value) : "-",
                    VariantText(row, CompliantPart::kTool), VariantText(row, CompliantPart::kLayer),
                    VariantText(row, CompliantPart::kMount), unit, NameOf(m.use),
                    row.error.empty() ? std::string(row.verdict()) : row.error);
  }
  const ValidationCounts counts = CountRows(rows);
  return text + fmt::format(
                    "{} rows: {} judged, {} within the measured spread ({} of {} levels and trends); {} "
                    "calibrate, {} not judged\n{}\n",
                    counts.rows, counts.judged, counts.within, counts.levels_and_trends_within,
                    counts.levels_and_trends, counts.calibrates, counts.not_judged, KindsText(counts));
}

std::string ValidationJson(std::span<const ValidationRow> rows, const std::string& command_line) {
  Json list = Json::array(), uses = Json::array();
  for (const ValidationRow& row : rows) list.push_back(RowJson(row));
  for (const PublishedUse& use : PublishedUses())
    uses.push_back({{"row", use.row}, {"value", use.value}, {"where", use.where}});
  const ValidationCounts counts = CountRows(rows);
  Json kinds = Json::object();
  for (const KindCount& kind : counts.kinds)
    kinds[std::string(NameOf(kind.use))] = {{"judged", kind.judged}, {"within", kind.within}};
  return base::JsonText(Json{{"schema", "osteon.validate/1"},
                             {"version", OSTEON_VERSION},
                             {"command", command_line},
                             {"counts",
                              {{"rows", counts.rows},
                               {"judged", counts.judged},
                               {"within", counts.within},
                               {"missed", counts.missed},
                               {"calibrates", counts.calibrates},
                               {"not_judged", counts.not_judged},
                               {"failed", counts.failed},
                               {"levels_and_trends", counts.levels_and_trends},
                               {"levels_and_trends_within", counts.levels_and_trends_within},
                               {"by_use", kinds}}},
                             {"rows", list},
                             {"fitted_constants", ConstantsJson()},
                             {"published_uses", uses}});
}

int RunValidate(const ValidateOptions& options) {
  const auto ids = ChooseRows(options.rows);
  if (!ids) return session::Fail("validate", ids.error());
  if (const std::string wrong = session::ValidateOutputFolder("--out", options.out);
      !options.out.empty() && !wrong.empty())
    return session::Fail("validate", wrong);
  if (const std::string wrong = session::ValidateOutputFile("--json", options.json); !wrong.empty())
    return session::Fail("validate", wrong);
  base::InstallInterrupt();
  ValidationLab lab({.config_root = options.config_root, .quick = options.quick});
  const std::size_t count = ids->empty() ? Measurements().size() : ids->size();
  std::vector<ValidationRow> rows;
  {
    base::PhaseProgress progress("osteon validate", static_cast<int>(count) + 1);
    rows = RunValidation(lab, *ids, [&](std::string_view id) { progress.BeginPhase(std::string(id)); });
    progress.Done();
  }
  fmt::print("{}", ValidationTable(rows));
  if (const std::string error = WriteFiles(options, rows); !error.empty())
    return session::Fail("validate", error, session::kFailed);
  if (base::Interrupted()) return base::InterruptExitCode();
  return CountRows(rows).failed > 0 ? session::kFailed : 0;
}

}  // namespace osteon::studies
