#include "session/gains/gains_watch.h"

#include <exception>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "config/reading/sections/read_gains.h"
#include "session/gains/gains_panel.h"

namespace osteon::session {
namespace {

constexpr double kPollInterval_s = 0.5;

// Lists the gains that differ: "mass_x 3 -> 2 kg, …".
std::string Changes(const control::Gains& before, const control::Gains& after) {
  std::vector<double> values_before;
  control::VisitGains(
      before, [&](const char*, const char*, const char*, double value) { values_before.push_back(value); });
  std::string text;
  std::size_t i = 0;
  control::VisitGains(after, [&](const char* name, const char* axis, const char* unit, double value) {
    const double from = values_before[i++];
    if (from == value) return;
    text += fmt::format("{}{}{}{} {:g} -> {:g}{}{}", text.empty() ? "" : ", ", name, *axis ? "_" : "", axis,
                        from, value, *unit ? " " : "", unit);
  });
  return text;
}

// Returns the file's modification time, or `otherwise` if the file cannot be found.
std::filesystem::file_time_type WrittenAt(const std::filesystem::path& file,
                                          std::filesystem::file_time_type otherwise) {
  std::error_code error;  // not reported: a file that is being replaced is absent for a moment
  const auto time = std::filesystem::last_write_time(file, error);
  return error ? otherwise : time;
}

}  // namespace

GainsWatch::GainsWatch(std::filesystem::path file, const config::CellConfig& cell, control::ServoLoop& loop,
                       std::function<void(const std::string&)> notice, GainsPanel* panel)
    : file_(std::move(file)),
      cell_(cell),
      loop_(loop),
      notice_(std::move(notice)),
      panel_(panel),
      asked_(control::GainsOf(cell.servo.admittance, cell.servo.coupling)) {
  if (!file_.empty()) read_ = seen_ = WrittenAt(file_, {});
}

void GainsWatch::Poll(double at_s) {
  if (panel_ != nullptr)
    if (const auto gains = panel_->Take()) Request(*gains);
  if (file_.empty() || at_s < next_s_) return;
  next_s_ = at_s + kPollInterval_s;
  const auto written = WrittenAt(file_, seen_);
  const bool is_settled = written == seen_;
  seen_ = written;
  if (is_settled && written != read_) {
    read_ = written;
    Read();
  }
}

void GainsWatch::Request(const control::Gains& gains) {
  const std::string changes = Changes(asked_, gains);
  if (changes.empty()) return;
  loop_.RequestGains(gains);
  asked_ = gains;
  if (notice_) notice_(fmt::format("gains: {} within {:g} s", changes, control::GainRamp::kRampSeconds));
}

void GainsWatch::Read() {
  const auto say = [this](const std::string& text) {
    if (notice_) notice_(text);
  };
  try {
    const control::Gains gains = config::ReadGainsAgain(file_, cell_.servo.law, cell_.own_gains,
                                                        cell_.servo.coupling.max_stiffness_N_per_m);
    const std::string changes = Changes(asked_, gains);
    if (changes.empty()) {
      say(fmt::format("gains: {} read again, nothing has changed", file_.string()));
      return;
    }
    Request(gains);
    if (panel_ != nullptr) panel_->SetPresent(gains);
  } catch (const std::exception& error) {
    say(fmt::format("gains stay as they are: {}", error.what()));
  }
}

}  // namespace osteon::session
