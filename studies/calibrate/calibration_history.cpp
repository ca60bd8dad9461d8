#include "studies/calibrate/calibration_history.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace osteon::studies {
namespace {

// A difference counts as drift if it exceeds both the value here for its quantity, and kSds times the
// combined standard deviation of the two fits.
constexpr double kMass_kg = 0.02, kCenter_m = 1e-3, kBias_N = 0.5, kApex_m = 1e-4, kSds = 3.0;

// Writes a vector's coordinates as a JSON array in a unit, and reads them back.
nlohmann::ordered_json InUnit(const Vector3& v, double unit) {
  return nlohmann::ordered_json::array({v.x() / unit, v.y() / unit, v.z() / unit});
}
Vector3 FromUnit(const nlohmann::json& list, double unit) {
  return {unit * list.at(0).get<double>(), unit * list.at(1).get<double>(), unit * list.at(2).get<double>()};
}

nlohmann::ordered_json JsonOf(const CalibrationEntry& entry) {
  nlohmann::ordered_json json{{"time", entry.time}};
  if (const auto& payload = entry.payload)
    json["payload"] = {{"mass_kg", payload->mass_kg},
                       {"mass_sd_kg", payload->mass_sd_kg},
                       {"center_mm", InUnit(payload->center_F_m, 1e-3)},
                       {"center_sd_mm", 1e3 * payload->center_sd_m},
                       {"bias_N", InUnit(payload->bias_N, 1.0)},
                       {"residual_N", payload->residual_N}};
  if (const auto& apex = entry.apex)
    json["tcp"] = {{"position_mm", InUnit(apex->p_FT_m, 1e-3)},
                   {"sd_mm", 1e3 * apex->sd_m},
                   {"residual_mm", 1e3 * apex->residual_m}};
  return json;
}

// @throws nlohmann::json::exception if the JSON is no calibration
CalibrationEntry EntryFrom(const nlohmann::json& json) {
  CalibrationEntry entry{.time = json.at("time").get<std::string>()};
  if (json.contains("payload")) {
    const nlohmann::json& payload = json.at("payload");
    entry.payload = CalibrationEntry::Payload{.mass_kg = payload.at("mass_kg"),
                                              .mass_sd_kg = payload.at("mass_sd_kg"),
                                              .center_F_m = FromUnit(payload.at("center_mm"), 1e-3),
                                              .center_sd_m = 1e-3 * payload.at("center_sd_mm").get<double>(),
                                              .bias_N = FromUnit(payload.at("bias_N"), 1.0),
                                              .residual_N = payload.at("residual_N")};
  }
  if (json.contains("tcp")) {
    const nlohmann::json& apex = json.at("tcp");
    entry.apex = CalibrationEntry::Apex{.p_FT_m = FromUnit(apex.at("position_mm"), 1e-3),
                                        .sd_m = 1e-3 * apex.at("sd_mm").get<double>(),
                                        .residual_m = 1e-3 * apex.at("residual_mm").get<double>()};
  }
  return entry;
}

// Whether a difference counts as drift: above `floor`, and above kSds times the combined standard deviation.
bool Differs(double difference, double floor, double sd_a, double sd_b) {
  return difference > floor && difference > kSds * std::hypot(sd_a, sd_b);
}

// Adds a sentence for each quantity that has drifted between two calibrations.
void Compare(const CalibrationEntry& before, const CalibrationEntry& now, std::vector<std::string>& drift) {
  const auto add = [&](const std::string& what, double found, double was, const char* unit) {
    drift.push_back(fmt::format("{}: found {:.4g} {}, {:.4g} on {}", what, found, unit, was, before.time));
  };
  if (now.payload && before.payload) {
    const CalibrationEntry::Payload &a = *before.payload, &b = *now.payload;
    if (Differs(std::abs(b.mass_kg - a.mass_kg), kMass_kg, a.mass_sd_kg, b.mass_sd_kg))
      add("the payload's mass has drifted", b.mass_kg, a.mass_kg, "kg");
    const double center_m = (b.center_F_m - a.center_F_m).norm(), bias_N = (b.bias_N - a.bias_N).norm();
    if (Differs(center_m, kCenter_m, a.center_sd_m, b.center_sd_m))
      drift.push_back(
          fmt::format("the payload's centre has drifted by {:.2f} mm since {}", 1e3 * center_m, before.time));
    if (Differs(bias_N, kBias_N, a.residual_N, b.residual_N))
      drift.push_back(fmt::format("the sensor's bias has drifted by {:.2f} N since {}", bias_N, before.time));
  }
  if (now.apex && before.apex) {
    const double apex_m = (now.apex->p_FT_m - before.apex->p_FT_m).norm();
    if (Differs(apex_m, kApex_m, before.apex->sd_m, now.apex->sd_m))
      drift.push_back(
          fmt::format("the tool's apex has drifted by {:.2f} mm since {}", 1e3 * apex_m, before.time));
  }
}

}  // namespace

std::filesystem::path HistoryFile(const std::filesystem::path& overlay) {
  std::filesystem::path file = overlay;
  return file.replace_extension(".history.jsonl");
}

tl::expected<std::vector<CalibrationEntry>, std::string> ReadHistory(const std::filesystem::path& file) {
  std::vector<CalibrationEntry> history;
  std::ifstream in(file);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty()) continue;
    try {
      history.push_back(EntryFrom(nlohmann::json::parse(line)));
    } catch (const nlohmann::json::exception& error) {
      return tl::unexpected(
          fmt::format("{}:{}: found a line that is no calibration ({}), accepted what `osteon "
                      "calibrate` appended: correct the line, or move the file away",
                      file.string(), number, error.what()));
    }
  }
  return history;
}

tl::expected<void, std::string> AppendHistory(const std::filesystem::path& file,
                                              const CalibrationEntry& entry) {
  std::ofstream out(file, std::ios::app);
  out << JsonOf(entry).dump() << '\n';
  out.flush();
  if (!out) return tl::unexpected(file.string() + ": could not be appended to");
  return {};
}

std::vector<std::string> DriftSince(const std::vector<CalibrationEntry>& history,
                                    const CalibrationEntry& now) {
  // Finds the first entry of a range that has the member (payload or apex).
  const auto find = [&](auto begin, auto end, auto member) {
    return std::find_if(begin, end, [&](const CalibrationEntry& e) { return (e.*member).has_value(); });
  };
  std::vector<std::string> drift;
  // Compares one member with its latest earlier value, and with its first value if that is an older one.
  const auto compare = [&](auto member) {
    const auto first = find(history.begin(), history.end(), member);
    if (first == history.end() || !(now.*member)) return;
    const auto last = find(history.rbegin(), history.rend(), member);
    const auto only = [&](const CalibrationEntry& entry) {
      CalibrationEntry part{.time = entry.time};
      part.*member = entry.*member;
      return part;
    };
    Compare(only(*last), only(now), drift);
    if (&*last != &*first) Compare(only(*first), only(now), drift);
  };
  compare(&CalibrationEntry::payload);
  compare(&CalibrationEntry::apex);
  return drift;
}

std::string UtcNow() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

}  // namespace osteon::studies
