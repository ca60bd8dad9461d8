#include "simulation/tools/tool_motion.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "base/units.h"

namespace osteon::simulation {
namespace {

constexpr std::string_view kFirstLine = "# osteon motion 1";
constexpr std::string_view kColumns = "time_s,x_mm,y_mm,z_mm,q_w,q_x,q_y,q_z,spindle_rpm";
constexpr std::size_t kColumnCount = 9;
constexpr std::array<std::string_view, kColumnCount> kColumnNames{
    "time_s", "x_mm", "y_mm", "z_mm", "q_w", "q_x", "q_y", "q_z", "spindle_rpm"};

constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
// Largest accepted values in a row: time [s], coordinate of a position [mm], spindle speed [rpm].
constexpr double kMaxSeconds = 36000.0, kFar_mm = 10000.0, kMaxRpm = 500'000.0;
// largest error of the quaternion's length: four values rounded to 1e-7, with a margin
constexpr double kUnitTolerance = 1e-5;
constexpr double kMaxSpeed_m_per_s = 5.0;

// The lines of the file's head that describe the motion's origin, in the file's order.
using OriginLine = std::pair<std::string_view, std::string MotionOrigin::*>;
constexpr std::array<OriginLine, 8> kOriginLines{{{"made by", &MotionOrigin::made_by},
                                                  {"scene", &MotionOrigin::scene},
                                                  {"cell", &MotionOrigin::cell},
                                                  {"tool", &MotionOrigin::tool},
                                                  {"engine", &MotionOrigin::engine},
                                                  {"clock", &MotionOrigin::clock},
                                                  {"command", &MotionOrigin::command},
                                                  {"interpolation error", &MotionOrigin::error}}};

// Rounds to a multiple of 1 / per_unit. The result is the double nearest to this decimal number, so its
// shortest text has no more decimal places. Minus zero becomes zero.
double Rounded(double value, double per_unit) { return std::round(value * per_unit) / per_unit + 0.0; }

// The values of a sample's row in the file, rounded as the file shows them.
std::array<double, kColumnCount> Row(const MotionSample& s) {
  const Vector3 p_mm = 1e3 * s.p_GT_m;
  return {Rounded(s.time_s, 1e6),   Rounded(p_mm.x(), 1e4),   Rounded(p_mm.y(), 1e4),
          Rounded(p_mm.z(), 1e4),   Rounded(s.R_GT.w(), 1e7), Rounded(s.R_GT.x(), 1e7),
          Rounded(s.R_GT.y(), 1e7), Rounded(s.R_GT.z(), 1e7), Rounded(s.spindle_rad_per_s / kRpm, 1e3)};
}

// The sample that a row's values describe.
MotionSample Sample(const std::array<double, kColumnCount>& row) {
  return {.time_s = row[0],
          .p_GT_m = 1e-3 * Vector3(row[1], row[2], row[3]),
          .R_GT = Eigen::Quaterniond(row[4], row[5], row[6], row[7]).normalized(),
          .spindle_rad_per_s = row[8] * kRpm};
}

// Shortens a text for an error message, and replaces control characters.
std::string Shortened(std::string_view text) {
  std::string shown(text.substr(0, 40));
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < 0x20) c = '?';
  return text.size() > shown.size() ? shown + "…" : shown;
}

// Reads a text line by line.
class MotionLines {
 public:
  explicit MotionLines(std::string_view text) : rest_(text) {}
  // Reads the next line. False at the end. Accepts LF and CRLF.
  bool Next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    ends_with_newline_ = end != std::string_view::npos;
    line = rest_.substr(0, end);
    rest_ = ends_with_newline_ ? rest_.substr(end + 1) : std::string_view{};
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++number_;
    return true;
  }
  // Number of the last line that was read, from 1.
  [[nodiscard]] int number() const { return number_; }
  // Whether the last line that was read ends with a newline.
  [[nodiscard]] bool ends_with_newline() const { return ends_with_newline_; }

 private:
  std::string_view rest_;
  int number_{0};
  bool ends_with_newline_{true};
};

// Reads a row and checks its values. @returns an empty string, or what is wrong with the row.
std::string ReadRow(std::string_view line, std::array<double, kColumnCount>& row) {
  const auto count = static_cast<std::size_t>(std::ranges::count(line, ',')) + 1;
  if (count != kColumnCount) return fmt::format("found {} values, accepted 9: {}", count, kColumns);
  for (std::size_t i = 0; i < kColumnCount; ++i) {
    const std::size_t comma = line.find(',');
    const std::string_view word = line.substr(0, comma);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), row[i]);
    if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(row[i]))
      return fmt::format("{}: found \"{}\", accepted a finite number", kColumnNames[i], Shortened(word));
    line.remove_prefix(comma == std::string_view::npos ? line.size() : comma + 1);
  }
  const auto within = [&](std::size_t i, double low, double high) {
    return row[i] >= low && row[i] <= high
               ? std::string()
               : fmt::format("{}: found {}, accepted {} … {}", kColumnNames[i], row[i], low, high);
  };
  if (auto wrong = within(0, 0.0, kMaxSeconds); !wrong.empty()) return wrong;
  for (std::size_t i = 1; i <= 3; ++i)
    if (auto wrong = within(i, -kFar_mm, kFar_mm); !wrong.empty()) return wrong;
  const double length = std::hypot(std::hypot(row[4], row[5]), std::hypot(row[6], row[7]));
  if (!(std::abs(length - 1.0) <= kUnitTolerance))
    return fmt::format("q_w … q_z: found a quaternion of length {:.7g}, accepted 1 ± 1e-05", length);
  return within(8, 0.0, kMaxRpm);
}

// Checks that time increases from one row to the next, and that the tool moves and turns no faster than
// accepted. @returns an empty string, or what is wrong.
std::string CheckStep(const MotionSample& before, const MotionSample& sample) {
  const double step_s = sample.time_s - before.time_s;
  if (!(step_s > 0.0))
    return fmt::format("time_s: found {}, accepted more than the {} of the row before", sample.time_s,
                       before.time_s);
  const double way_m = (sample.p_GT_m - before.p_GT_m).norm();
  if (way_m > kMaxSpeed_m_per_s * step_s)
    return fmt::format("x_mm … z_mm: found {:.6g} mm in {:.6g} s, accepted at most {} m/s", way_m * 1e3,
                       step_s, kMaxSpeed_m_per_s);
  const double turn_rad = before.R_GT.angularDistance(sample.R_GT);
  if (turn_rad > std::numbers::pi / 2.0)
    return fmt::format("q_w … q_z: found a turn of {:.4g} deg from the row before, accepted at most 90",
                       turn_rad * 180.0 / std::numbers::pi);
  return {};
}

}  // namespace

MotionSample Rounded(const MotionSample& sample) { return Sample(Row(sample)); }

std::string MotionText(const ToolMotion& motion) {
  std::string text(kFirstLine);
  text += '\n';
  for (const auto& [key, member] : kOriginLines) {
    std::string value = motion.origin.*member;
    for (char& c : value)
      if (c == '\n' || c == '\r') c = ' ';
    text += fmt::format("# {}: {}\n", key, value);
  }
  text += kColumns;
  text += '\n';
  for (const MotionSample& sample : motion.samples) {
    const auto row = Row(sample);
    for (std::size_t i = 0; i < row.size(); ++i) text += fmt::format("{}{}", i == 0 ? "" : ",", row[i]);
    text += '\n';
  }
  return text;
}

tl::expected<ToolMotion, std::string> ParseMotion(const std::string& text, const std::string& name) {
  ToolMotion motion;
  MotionLines lines(text);
  std::string_view line;
  const auto refuse = [&](const std::string& what) {
    return tl::make_unexpected(fmt::format("{}:{}: {}", name, lines.number(), what));
  };
  if (text.size() > kMaxBytes)
    return tl::make_unexpected(
        fmt::format("{}: found {} bytes, accepted at most {}", name, text.size(), kMaxBytes));
  if (!lines.Next(line)) return tl::make_unexpected(name + ": found an empty file, accepted a motion");
  if (line != kFirstLine)
    return refuse(fmt::format("found \"{}\", accepted \"{}\"", Shortened(line), kFirstLine));
  for (const auto& [key, member] : kOriginLines) {
    const std::string begin = fmt::format("# {}: ", key);
    if (!lines.Next(line) || !line.starts_with(begin) || line.size() == begin.size())
      return refuse(fmt::format("found \"{}\", accepted \"{}\" and its text", Shortened(line), begin));
    motion.origin.*member = line.substr(begin.size());
  }
  if (!lines.Next(line) || line != kColumns)
    return refuse(fmt::format("found \"{}\", accepted the columns {}", Shortened(line), kColumns));

  std::array<double, kColumnCount> row{};
  while (lines.Next(line)) {
    if (!lines.ends_with_newline())
      return refuse("found a row without a line end, accepted a file that is complete");
    if (motion.samples.size() == kMaxMotionRows)
      return refuse(fmt::format("found more rows, accepted at most {}", kMaxMotionRows));
    if (const std::string wrong = ReadRow(line, row); !wrong.empty()) return refuse(wrong);
    const MotionSample sample = Sample(row);
    if (motion.samples.empty()) {
      if (sample.time_s != 0.0)
        return refuse(fmt::format("time_s: found {} in the first row, accepted 0", sample.time_s));
    } else if (const std::string wrong = CheckStep(motion.samples.back(), sample); !wrong.empty()) {
      return refuse(wrong);
    }
    motion.samples.push_back(sample);
  }
  if (motion.samples.size() < 2)
    return refuse(fmt::format("found {} rows, accepted at least 2", motion.samples.size()));
  return motion;
}

tl::expected<ToolMotion, std::string> LoadMotion(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    return tl::make_unexpected(name + ": found no file, accepted a motion");
  const auto bytes = std::filesystem::file_size(path, error);
  if (error) return tl::make_unexpected(name + ": can not be read: " + error.message());
  if (bytes > kMaxBytes)  // check the size before reading the file
    return tl::make_unexpected(
        fmt::format("{}: found {} bytes, accepted at most {}", name, bytes, kMaxBytes));
  std::ostringstream text;
  std::ifstream file(path, std::ios::binary);
  text << file.rdbuf();
  if (!file) return tl::make_unexpected(name + ": can not be read");
  return ParseMotion(text.str(), name);
}

}  // namespace osteon::simulation
