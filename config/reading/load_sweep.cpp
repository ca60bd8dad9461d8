#include "config/reading/load_sweep.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <system_error>

#include <fmt/format.h>

#include "config/reading/strict/reader.h"

namespace osteon::config {
namespace {

constexpr int kMaxSeeds = 100'000, kMaxSteps = 10'000;
constexpr const char* kAccepted =
    "accepted a list (5, 10, 20), \"A to B in N steps\", \"uniform A to B\", \"normal MEAN sd S\", or "
    "\"seed\"";

// Parses the whole text as a finite number; nothing if it is no such number.
std::optional<double> NumberFrom(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || rest != end || !std::isfinite(value)) return {};
  return value;
}

// Returns the parts between separators, without spaces around them.
std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) {
    const std::size_t begin = part.find_first_not_of(' '), end = part.find_last_not_of(' ');
    parts.push_back(begin == std::string::npos ? "" : part.substr(begin, end - begin + 1));
  }
  return parts;
}

// Returns the numbers in a text of a given form, such as "uniform # to #", in which # stands for a number.
// Nothing if the text does not have this form.
std::optional<std::vector<double>> NumbersOf(const std::string& text, const std::string& form) {
  std::istringstream words(text), accepted(form);
  std::vector<double> numbers;
  std::string word, expected;
  while (accepted >> expected) {
    if (!(words >> word)) return {};
    if (expected != "#") {
      if (word != expected) return {};
      continue;
    }
    const auto number = NumberFrom(word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  if (words >> word) return {};
  return numbers;
}

// Fills a parameter from a text such as "uniform 0 to 4". @returns whether the text has an accepted form
// (kAccepted).
bool ReadTakes(const std::string& text, SweepParameter& parameter) {
  if (text == "seed") {
    parameter.draw = SweepDraw::kSeed;
  } else if (const auto uniform = NumbersOf(text, "uniform # to #")) {
    parameter.draw = SweepDraw::kUniform;
    parameter.low = (*uniform)[0];
    parameter.high = (*uniform)[1];
    return parameter.low < parameter.high && std::isfinite(parameter.high - parameter.low);
  } else if (const auto normal = NumbersOf(text, "normal # sd #")) {
    parameter.draw = SweepDraw::kNormal;
    parameter.mean = (*normal)[0];
    parameter.sd = (*normal)[1];
    return parameter.sd > 0.0;
  } else if (const auto steps = NumbersOf(text, "# to # in # steps")) {
    const double from = (*steps)[0], to = (*steps)[1], count = (*steps)[2];
    if (!(count >= 2.0 && count <= kMaxSteps) || count != std::floor(count) || !(from < to) ||
        !std::isfinite(to - from))
      return false;
    for (int i = 0; i < static_cast<int>(count); ++i)
      parameter.values.push_back(fmt::format("{:.10g}", from + (to - from) * i / (count - 1.0)));
  } else {
    parameter.values = Split(text, ',');
    return std::ranges::all_of(parameter.values, [](const std::string& value) {
      return !value.empty() && value.find(' ') == std::string::npos;
    });
  }
  return true;
}

}  // namespace

SweepConfig LoadSweep(const std::filesystem::path& file) {
  Reader reader = Reader::Load(file);
  SweepConfig sweep;
  sweep.file = file;
  sweep.name = file.stem().string();
  sweep.shows = reader.Text("shows");
  sweep.scenario = reader.File("scenario", "scenarios");
  sweep.seeds = reader.WholeNumber("seed_count", 1, kMaxSeeds);
  std::vector<Reader> sections = reader.Sections("parameters", 1, 20);
  for (Reader& section : sections) {
    SweepParameter parameter{.key = section.Text("key")};
    const std::string takes = section.Text("takes");
    const bool known = ReadTakes(takes, parameter);
    if (!known) section.Refuse("takes", fmt::format("found \"{}\", {}", takes, kAccepted));
    sweep.parameters.push_back(std::move(parameter));
  }
  reader.Finish();

  for (std::size_t i = 0; i < sections.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (sweep.parameters[i].key == sweep.parameters[j].key)
        sections[i].Refuse("key", fmt::format("found {} twice, accepted once", sweep.parameters[i].key));
  const bool draws = std::ranges::any_of(
      sweep.parameters, [](const SweepParameter& p) { return p.draw != SweepDraw::kListed; });
  if (!draws && sweep.seeds > 1)
    reader.Refuse("seed_count",
                  fmt::format("found {}, accepted 1 where no parameter is drawn: all seeds would be the same",
                              sweep.seeds));
  double runs = sweep.seeds;
  for (const SweepParameter& parameter : sweep.parameters)
    if (parameter.draw == SweepDraw::kListed) runs *= static_cast<double>(parameter.values.size());
  if (runs > static_cast<double>(kMaxSweepRuns))
    reader.Refuse("parameters", fmt::format("found {:.0f} runs, accepted {} at most", runs, kMaxSweepRuns));
  return sweep;
}

}  // namespace osteon::config
