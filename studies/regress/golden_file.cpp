#include "studies/regress/golden_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "base/no_file_text.h"

namespace osteon::studies {
namespace {

constexpr const char* kFirstLine = "osteon golden trace 1";
constexpr std::uintmax_t kMaxFileBytes = 8u << 20u;
constexpr std::size_t kTicksALine = 8;           // ticks whose digests are on one line
constexpr std::uint64_t kMaxTicks = 10'000'000;  // maximum number of ticks of an accepted trace
// The characters of base64, each for 6 bits.
constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

// Replaces control characters by spaces, so that a user's text stays on its line.
std::string OneLine(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return text;
}

// Formats a value without trailing zeros, and never as "-0".
std::string Short(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

// A sample's values in the order of TraceQuantities, each preceded by a space.
std::string Values(const std::vector<double>& values) {
  std::string text;
  const auto quantities = TraceQuantities();
  for (std::size_t i = 0; i < values.size(); ++i)
    text += ' ' + Short(values[i], DecimalsOf(quantities[i].kind));
  return text;
}

// Reads the lines of a text, word by word.
class Lines {
 public:
  Lines(const std::string& text, std::string name) : rest_(text), name_(std::move(name)) {}

  // Goes to the next line. Returns false at the text's end.
  bool Next() {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line_ = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    ++number_;
    return true;
  }
  [[nodiscard]] std::string_view RestOfLine() const { return line_; }
  // Removes the next word from the line; empty at the line's end.
  std::string_view Word() {
    const std::size_t end = std::min(line_.find(' '), line_.size());
    const std::string_view word = line_.substr(0, end);
    line_.remove_prefix(std::min(end + 1, line_.size()));
    return word;
  }
  // Removes the next word from the line and reads it as a number; nothing if it is not a number, or not
  // finite.
  template <class T>
  std::optional<T> Number(int base = 10) {
    const std::string_view word = Word();
    T value{};
    std::from_chars_result read{};
    if constexpr (std::is_floating_point_v<T>)
      read = std::from_chars(word.data(), word.data() + word.size(), value);
    else
      read = std::from_chars(word.data(), word.data() + word.size(), value, base);
    last_ = word;
    if (read.ec != std::errc{} || read.ptr != word.data() + word.size()) return {};
    if constexpr (std::is_floating_point_v<T>)
      if (!std::isfinite(value)) return {};
    return value;
  }

  // Returns an error at the present line.
  [[nodiscard]] tl::unexpected<std::string> Refuse(const std::string& what) const {
    return tl::make_unexpected(fmt::format("{}:{}: {}", name_, number_, what));
  }
  // Returns an error at the present line that quotes the word last read as a number.
  [[nodiscard]] tl::unexpected<std::string> RefuseWord(std::string_view key, const char* accepted) const {
    return Refuse(fmt::format("{}: found \"{}\", accepted {}", key, OneLine(std::string(last_.substr(0, 40))),
                              accepted));
  }
  [[nodiscard]] std::string_view last() const { return last_; }

 private:
  std::string_view rest_, line_, last_;
  std::string name_;
  int number_{0};
};

// Reads a sample's values; nothing unless the rest of the line has exactly one number for each quantity.
std::optional<std::vector<double>> ReadValues(Lines& lines) {
  std::vector<double> values;
  for (std::size_t i = 0; i < TraceQuantities().size(); ++i) {
    const auto value = lines.Number<double>();
    if (!value) return {};
    values.push_back(*value);
  }
  if (!lines.RestOfLine().empty()) return {};
  return values;
}

// Reads a tick's digest: two characters for the 12 bits of each part.
std::optional<TickDigest> ReadDigest(std::string_view word) {
  if (word.size() != 2 * kTraceParts) return {};
  TickDigest digest{};
  for (std::size_t i = 0; i < kTraceParts; ++i) {
    const std::size_t high = kAlphabet.find(word[2 * i]), low = kAlphabet.find(word[2 * i + 1]);
    if (high == std::string_view::npos || low == std::string_view::npos) return {};
    digest[i] = static_cast<std::uint16_t>(high << 6u | low);
  }
  return digest;
}

// The names of the quantities, each preceded by a space.
std::string Columns() {
  std::string text;
  for (const TraceQuantity& quantity : TraceQuantities()) text += ' ' + quantity.name;
  return text;
}

}  // namespace

std::string GoldenText(const Golden& golden) {
  const GoldenHead& head = golden.head;
  const ScenarioTrace& trace = golden.trace;
  std::string text = fmt::format("{}\nscenario {}\n", kFirstLine, OneLine(head.scenario));
  for (const std::string& reason : head.reasons) text += fmt::format("reason {}\n", OneLine(reason));
  text += fmt::format("build {}\nmachine {}\nengine {}\n", OneLine(head.build), OneLine(head.machine),
                      OneLine(head.engine));
  for (const GoldenSource& source : head.sources)
    text += fmt::format("file {} {}\n", source.checksum, OneLine(source.path));
  text += fmt::format("period_s {}\nticks {}\nactive {}\nhash {:016x}\nended {}\n", trace.period_s,
                      trace.ticks, trace.active, trace.hash, OneLine(trace.ended));
  for (const TraceEvent& event : trace.events)
    text += fmt::format("event {} {}\n", event.tick, OneLine(event.what));
  text += "columns" + Columns() + "\n";
  if (!trace.least.empty())
    text += fmt::format("least{}\ngreatest{}\n", Values(trace.least), Values(trace.greatest));
  for (const TraceSample& sample : trace.samples)
    text += fmt::format("sample {}{}\n", sample.tick, Values(sample.values));
  text += fmt::format("digests {}", trace.first_tick);
  for (std::size_t i = 0; i < trace.digests.size(); ++i) {
    text += i % kTicksALine == 0 ? '\n' : ' ';
    for (const std::uint16_t part : trace.digests[i]) {
      text += kAlphabet[part >> 6u];
      text += kAlphabet[part & 63u];
    }
  }
  return text + "\nend\n";
}

tl::expected<Golden, std::string> ParseGolden(const std::string& text, const std::string& name) {
  Golden golden;
  ScenarioTrace& trace = golden.trace;
  Lines lines(text, name);
  if (!lines.Next() || lines.RestOfLine() != kFirstLine)
    return lines.Refuse(fmt::format("found no golden trace, accepted \"{}\" in the first line", kFirstLine));

  constexpr const char* kCount = "a whole number";
  bool has_columns = false, has_hash = false, has_period = false, has_digests = false, ended = false;
  while (!ended && lines.Next()) {
    const std::string_view key = lines.Word();
    if (key == "scenario") {
      golden.head.scenario = lines.RestOfLine();
    } else if (key == "reason") {
      golden.head.reasons.emplace_back(lines.RestOfLine());
    } else if (key == "build") {
      golden.head.build = lines.RestOfLine();
    } else if (key == "machine") {
      golden.head.machine = lines.RestOfLine();
    } else if (key == "engine") {
      golden.head.engine = lines.RestOfLine();
    } else if (key == "file") {
      const std::string checksum(lines.Word());
      golden.head.sources.push_back({.path = std::string(lines.RestOfLine()), .checksum = checksum});
    } else if (key == "ended") {
      trace.ended = lines.RestOfLine();
    } else if (key == "period_s") {
      const auto period = lines.Number<double>();
      if (!period || !(*period >= 1e-4 && *period <= 1.0)) return lines.RefuseWord("period_s", "0.0001 … 1");
      trace.period_s = *period;
      has_period = true;
    } else if (key == "ticks" || key == "active") {
      const auto count = lines.Number<std::uint64_t>();
      if (!count || *count > kMaxTicks) return lines.RefuseWord(key, "0 … 10000000");
      (key == "ticks" ? trace.ticks : trace.active) = *count;
    } else if (key == "hash") {
      const auto hash = lines.Number<std::uint64_t>(16);
      if (!hash || lines.last().size() != 16) return lines.RefuseWord("hash", "16 hexadecimal digits");
      trace.hash = *hash;
      has_hash = true;
    } else if (key == "event") {
      const auto tick = lines.Number<std::uint64_t>();
      if (!tick || *tick > kMaxTicks) return lines.RefuseWord("event", kCount);
      trace.events.push_back({.tick = *tick, .what = std::string(lines.RestOfLine())});
    } else if (key == "columns") {
      if (" " + std::string(lines.RestOfLine()) != Columns())
        return lines.Refuse(
            "found other columns than this version samples: accept the trace anew (--update)");
      has_columns = true;
    } else if (key == "least" || key == "greatest") {
      const auto values = ReadValues(lines);
      if (!has_columns || !values)
        return lines.Refuse(
            fmt::format("found no {} finite numbers behind the columns", TraceQuantities().size()));
      (key == "least" ? trace.least : trace.greatest) = *values;
    } else if (key == "sample") {
      const auto tick = lines.Number<std::uint64_t>();
      if (!tick || *tick > kMaxTicks) return lines.RefuseWord("sample", kCount);
      if (!trace.samples.empty() && *tick <= trace.samples.back().tick)
        return lines.RefuseWord("sample", "a tick after the one before");
      auto values = ReadValues(lines);
      if (!has_columns || !values)
        return lines.Refuse(
            fmt::format("found no {} finite numbers behind the columns", TraceQuantities().size()));
      trace.samples.push_back({.tick = *tick, .values = std::move(*values)});
    } else if (key == "digests") {
      const auto tick = lines.Number<std::uint64_t>();
      if (!tick || *tick > kMaxTicks) return lines.RefuseWord("digests", kCount);
      trace.first_tick = *tick;
      has_digests = true;
      while (lines.Next() && lines.RestOfLine() != "end") {
        while (!lines.RestOfLine().empty()) {
          const std::string_view word = lines.Word();
          const auto digest = ReadDigest(word);
          if (!digest)
            return lines.Refuse(fmt::format("digests: found \"{}\", accepted {} characters of base64",
                                            OneLine(std::string(word.substr(0, 40))), 2 * kTraceParts));
          trace.digests.push_back(*digest);
        }
      }
      ended = lines.RestOfLine() == "end";
    } else {
      return lines.Refuse(fmt::format("found \"{}\", accepted a key of a golden trace",
                                      OneLine(std::string(key.substr(0, 40)))));
    }
  }
  if (!ended || !has_columns || !has_hash || !has_period || !has_digests)
    return lines.Refuse("the file ends before the trace does");
  // A valid trace has extremes if and only if it has digests, and its digests belong to ticks of the run.
  if (trace.least.size() != trace.greatest.size() || trace.least.empty() == !trace.digests.empty() ||
      trace.first_tick + trace.digests.size() > trace.ticks + (trace.digests.empty() ? trace.first_tick : 0))
    return lines.Refuse("found counts that do not fit each other: least, greatest, digests, ticks");
  return golden;
}

tl::expected<Golden, std::string> ReadGolden(const std::filesystem::path& file) {
  std::error_code error;
  if (const std::string wrong = base::NoFileText(file); !wrong.empty())
    return tl::make_unexpected(fmt::format("{}: {}", file.string(), wrong));
  if (std::filesystem::file_size(file, error) > kMaxFileBytes)
    return tl::make_unexpected(fmt::format("{}: larger than 8 MiB: no golden trace", file.string()));
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) return tl::make_unexpected(fmt::format("{}: can not be read", file.string()));
  return ParseGolden(text, file.string());
}

std::vector<std::string> ReadReasons(const std::filesystem::path& file) {
  constexpr std::string_view kKey = "reason ";
  constexpr std::size_t kMaxReasons = 1000;
  std::vector<std::string> reasons;
  std::ifstream stream(file, std::ios::binary);
  for (std::string line;
       std::getline(stream, line) && !line.starts_with("columns") && reasons.size() < kMaxReasons;)
    if (line.starts_with(kKey)) reasons.push_back(line.substr(kKey.size()));
  return reasons;
}

}  // namespace osteon::studies
