#include "console/stream/live_json.h"

#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/clock.h"

namespace osteon::console {
namespace {

using Text = fmt::memory_buffer;

// Each Append of a number, a vector or a pose writes its numbers, each with a comma after it.
void Append(Text& text, double value) { fmt::format_to(std::back_inserter(text), "{:.6g},", value); }

void Append(Text& text, const PlainVector3& v) {
  Append(text, v.x);
  Append(text, v.y);
  Append(text, v.z);
}

void Append(Text& text, const PlainPose& X) {
  const std::array<double, 3> p{X.p.x, X.p.y, X.p.z};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) Append(text, X.R[3 * row + column]);
    Append(text, p[row]);
  }
}

void Append(Text& text, std::string_view part) { text.append(part); }

// Ends a list: replaces the comma at its end by the bracket.
void EndList(Text& text) {
  if (text.size() > 0 && text[text.size() - 1] == ',') text.resize(text.size() - 1);
  text.push_back(']');
}

// Appends a window's list of numbers, in the order of kStripFields.
void AppendRow(Text& text, const LiveWindow& w, const LiveContext& context) {
  const bool has_frame = w.frame.model.frame > 0;
  const double depth_m = !has_frame        ? 0.0
                         : context.depth_m ? context.depth_m(w.frame.model.X_WP)
                                           : w.frame.cup_depth_m;
  Append(text, "[");
  fmt::format_to(std::back_inserter(text), "{:.3f},", rt::ToSeconds(w.tick.stamp));
  Append(text, w.force_N.least);
  Append(text, w.force_N.most);
  Append(text, w.hand_N.most);
  Append(text, 1e3 * depth_m);
  Append(text, 1e9 * w.frame.model.removed_volume_m3);
  Append(text, w.compute_us.most);
  Append(text, w.wakeup_us.most);
  Append(text, 1e-3 * static_cast<double>(w.frame.duration_ns));
  Append(text, 1e3 * w.speed_m_per_s.most);
  EndList(text);
}

// Appends "view": tool, poses, joints, forces and contacts of the window's last tick and frame.
void AppendView(Text& text, const LiveWindow& w) {
  const simulation::ContactModel& model = w.frame.model;
  fmt::format_to(std::back_inserter(text), R"("view":{{"tool":{},"X_WT":[)", w.tick.input.tool_index);
  Append(text, w.tick.X_WT_cmd);
  EndList(text);
  if (model.frame > 0) {
    Append(text, R"(,"X_WP":[)");
    Append(text, model.X_WP);
    EndList(text);
  }
  if (const control::ComplianceRecord& compliance = w.tick.compliance; compliance.present) {
    Append(text, R"(,"X_WM":[)");
    Append(text, compliance.X_WM);
    EndList(text);
    Append(text, R"(,"X_WE":[)");
    Append(text, PlainPose(Pose(Pose(compliance.X_WM) * Pose(compliance.X_ME))));
    EndList(text);
    Append(text, R"(,"layer":[)");
    Append(text, compliance.layer_m);
    EndList(text);
  }
  Append(text, R"(,"q":[)");
  for (const double q : w.tick.q_meas) Append(text, q);
  EndList(text);
  Append(text, R"(,"force":[)");
  Append(text, w.tick.F_coupling_T_W.f);
  EndList(text);
  Append(text, R"(,"hand":[)");
  Append(text, w.tick.F_operator_T_W.f);
  EndList(text);
  Append(text, R"(,"contacts":[)");
  for (std::int32_t i = 0; i < model.contact_count; ++i) {
    const simulation::Contact& contact = model.contacts[static_cast<std::size_t>(i)];
    Append(text, "[");
    Append(text, contact.p_W_m);
    Append(text, contact.n_W);
    Append(text, contact.gap_m);
    EndList(text);
    Append(text, ",");
  }
  EndList(text);
  Append(text, "}");
}

}  // namespace

std::string LiveJson(std::span<const LiveWindow> windows, const LiveContext& context) {
  Text text;
  Append(text, R"({"type":"live","windows":[)");
  for (const LiveWindow& window : windows) {
    AppendRow(text, window, context);
    Append(text, ",");
  }
  EndList(text);
  Append(text, R"(,"status":)");
  Append(text, StatusJson(StatusOf(windows.back(), context)));
  Append(text, ",");
  AppendView(text, windows.back());
  Append(text, "}");
  return fmt::to_string(text);
}

std::string EventsJson(std::span<const io::RecordedEvent> events) {
  nlohmann::json rows = nlohmann::json::array();
  for (const io::RecordedEvent& event : events) rows.push_back({rt::ToSeconds(event.stamp), event.text});
  const nlohmann::json json{{"type", "events"}, {"events", rows}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace osteon::console
