#include "studies/diff/run_difference.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "session/summary/each_fault.h"

namespace osteon::studies {
namespace {

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Finds the first line in which two texts of a file differ; a line that one text lacks is empty.
ConfigDifference FirstDifferingLine(const std::string& file, const std::string& first,
                                    const std::string& second) {
  const std::vector<std::string> a = Lines(first), b = Lines(second);
  std::size_t i = 0;
  while (i < std::min(a.size(), b.size()) && a[i] == b[i]) ++i;
  return {.file = file,
          .first = i < a.size() ? a[i] : "",
          .second = i < b.size() ? b[i] : "",
          .line = static_cast<int>(i) + 1};
}

// The configuration files that are not the same in both runs.
std::vector<ConfigDifference> CompareConfig(const io::SessionInfo& first, const io::SessionInfo& second) {
  std::map<std::string, std::pair<const std::string*, const std::string*>> files;
  for (const io::ConfigFile& file : first.config.files) files[file.name].first = &file.content;
  for (const io::ConfigFile& file : second.config.files) files[file.name].second = &file.content;
  std::vector<ConfigDifference> differences;
  const std::string none;
  for (const auto& [name, both] : files) {
    const std::string& a = both.first ? *both.first : none;
    const std::string& b = both.second ? *both.second : none;
    if (a != b) differences.push_back(FirstDifferingLine(name, a, b));
  }
  return differences;
}

// Returns a line "name: first | second" for each property of the sessions that differs.
std::vector<std::string> CompareSessions(const io::SessionInfo& first, const io::SessionInfo& second) {
  std::vector<std::string> lines;
  const auto compare = [&](const char* name, const std::string& a, const std::string& b) {
    if (a != b)
      lines.push_back(fmt::format("{}: {} | {}", name, a.empty() ? "none" : a, b.empty() ? "none" : b));
  };
  compare("version", first.version, second.version);
  compare("build", first.build, second.build);
  compare("machine", first.machine, second.machine);
  compare("engine", first.engine, second.engine);
  compare("device", first.device, second.device);
  compare("scene", first.scene, second.scene);
  compare("tool", first.tool, second.tool);
  compare("cell", first.config.cell_file, second.config.cell_file);
  compare("gains", first.config.gains_file, second.config.gains_file);
  compare("identified", first.config.identified_file, second.config.identified_file);
  return lines;
}

// Names of the faults that `run` has and `other` has not.
std::vector<std::string> FaultsOnlyIn(const RunFigures& run, const RunFigures& other) {
  std::vector<std::string> names;
  session::ForEachFault(run.faults, [&](safety::Fault fault, const safety::FaultText& text) {
    if (!other.faults.Has(fault)) names.emplace_back(text.name);
  });
  return names;
}

// @param within  share of the larger value up to which the figures count as the same
FigureDifference Compare(const RunFigure& a, const RunFigure& b, double within) {
  return {.first = a,
          .second = b,
          .difference = b.value - a.value,
          .accepted = std::max({a.least_difference, b.least_difference,
                                within * std::max(std::abs(a.value), std::abs(b.value))})};
}

// Compares the results that identify estimates from both runs.
// @param only  receives a line for each result that only one of the runs has
void CompareExcited(const ExcitedFigures& first, const ExcitedFigures& second, double within,
                    std::vector<std::string>& only, RunDifference& runs) {
  const auto has = [](const ExcitedFigures& excited, const std::string& key) {
    return std::ranges::find(excited.figures, key, &RunFigure::key) != excited.figures.end();
  };
  for (const RunFigure& a : first.figures) {
    const auto b = std::ranges::find(second.figures, a.key, &RunFigure::key);
    if (b == second.figures.end())
      only.push_back("only the first run has the " + a.name);
    else
      runs.figures.push_back(Compare(a, *b, within));
  }
  for (const RunFigure& b : second.figures)
    if (!has(first, b.key)) only.push_back("only the second run has the " + b.name);
  runs.responses = CompareResponses(first, second, within, only);
  if (first.excitation != second.excitation)
    only.push_back(fmt::format("the excitation differs: {} | {}", first.excitation, second.excitation));
  for (const auto& [which, run] : {std::pair{"first", &first}, {"second", &second}})
    if (!run->refused.empty())
      only.push_back(fmt::format("the {} run was not estimated: {}", which, run->refused));
}

// Describes a response that differs, for the verdict: how many lines differ, and which one the most.
std::string ResponseText(const ResponseDifference& response) {
  const LineDifference& worst = response.worst();
  return fmt::format(
      "response by {}: {} of {} lines differ, most at {:g} Hz: {:.4g} and {:.4g}, {:.3g} apart where {:.2g} "
      "is "
      "accepted",
      response.by, response.differing(), response.lines.size(), worst.first.hz, std::abs(worst.first.value),
      std::abs(worst.second.value), std::abs(worst.first.value - worst.second.value), worst.accepted);
}

// The verdict of RunDifference, with a reason for each difference.
// @param only  results of identify that only one of the two runs has
report::ReportVerdict Judge(const RunDifference& runs, const RunFigures& first, const RunFigures& second,
                            const std::vector<std::string>& only) {
  report::ReportVerdict verdict;
  const auto add_reason = [&](const char* level, std::string reason) {  // never lowers "bad"
    if (verdict.level != "bad") verdict.level = level;
    verdict.reasons.push_back(std::move(reason));
  };
  for (const std::string& line : only) add_reason("look", line);
  for (const ResponseDifference& response : runs.responses)
    if (response.differing() > 0) add_reason("look", ResponseText(response));
  for (const std::string& name : runs.only_second)
    add_reason("bad", "only the second run has the fault " + name);
  for (const std::string& name : runs.only_first)
    add_reason("look", "only the first run has the fault " + name);
  for (const FigureDifference& figure : runs.figures)
    if (figure.differs())
      add_reason("look", fmt::format("{}: {:.4g} and {:.4g} {}, {:+.3g} where {:.3g} is accepted",
                                     figure.first.name, figure.first.value, figure.second.value,
                                     figure.first.unit, figure.difference, figure.accepted));
  if (!first.end_error.empty()) add_reason("look", "the first recording: " + first.end_error);
  if (!second.end_error.empty()) add_reason("look", "the second recording: " + second.end_error);
  if (verdict.level == "good")
    verdict.reasons.emplace_back(runs.identical ? "every tick is the same, to the bit" : "no figure differs");
  if (!runs.config.empty())
    verdict.reasons.push_back(fmt::format("the configuration differs in {} file{}", runs.config.size(),
                                          runs.config.size() == 1 ? "" : "s"));
  return verdict;
}

}  // namespace

bool FigureDifference::differs() const { return first.judged && !(std::abs(difference) <= accepted); }

RunDifference CompareRuns(const RunFigures& first, const RunFigures& second, double within) {
  RunDifference runs;
  runs.identical = first.ticks == second.ticks && first.hash == second.hash;
  for (std::size_t i = 0; i < std::min(first.figures.size(), second.figures.size()); ++i) {
    runs.figures.push_back(Compare(first.figures[i], second.figures[i], within));
  }
  std::vector<std::string> only;
  if (first.excited && second.excited) CompareExcited(*first.excited, *second.excited, within, only, runs);
  runs.only_first = FaultsOnlyIn(first, second);
  runs.only_second = FaultsOnlyIn(second, first);
  runs.config = CompareConfig(first.session, second.session);
  runs.session = CompareSessions(first.session, second.session);
  runs.verdict = Judge(runs, first, second, only);
  return runs;
}

std::string NotComparable(const RunFigures& first, const RunFigures& second) {
  const auto kind = [](const RunFigures& run) {
    return run.excited ? run.excited->kind + " of osteon identify" : std::string("an ordinary run");
  };
  if (kind(first) == kind(second)) return "";
  return fmt::format("found {} and {}, accepted two of one kind", kind(first), kind(second));
}

}  // namespace osteon::studies
