#include "session/gains/gains_panel.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "control/setup/servo_params.h"

namespace osteon::session {
namespace {

// Number of changes that can be undone; the oldest ones are forgotten.
constexpr std::size_t kMaxFormer = 100;
// Relative tolerance of the bounds, because a page rounds the bounds that it shows and may send a rounded
// bound as a request.
constexpr double kRounding = 1e-6;

bool IsWithin(double value, double low, double high) {
  return value >= low * (1.0 - kRounding) && value <= high * (1.0 + kRounding);
}

}  // namespace

GainsPanel::GainsPanel(const config::CellConfig& cell)
    : own_(control::GainsOf(cell.servo.admittance, cell.servo.coupling)),
      has_drag_(cell.servo.law == control::Law::kAdmittance),
      planes_N_per_m_(control::ForceLimit_N(cell.servo) / cell.servo.stabilisers.age_governor.tool_radius_m),
      present_(own_) {}

// Returns the smallest drag of the three axes, because it determines stability.
double GainsPanel::MinDrag(const control::Gains& gains) const {
  const PlainVector3& d = gains.damping_Ns_per_m;
  return std::min({d.x, d.y, d.z});
}

console::RequestAnswer GainsPanel::Request(const console::GainsRequest& request) {
  using Kind = console::GainsRequest::Kind;
  const std::lock_guard lock(mutex_);
  if (request.kind == Kind::kUndo) {
    if (former_.empty()) return {.done = false, .reason = "no change of the gains that could be undone"};
    present_ = former_.back();
    former_.pop_back();
    asked_ = true;
    return {.done = true, .reason = ""};
  }
  control::Gains next = present_;
  if (request.kind == Kind::kStiffness) {
    const double high = own_.max_stiffness_N_per_m, low = kMinStiffnessShare * high;
    if (!IsWithin(request.value, low, high))
      return {
          .done = false,
          .reason = fmt::format("stiffness: found {:g} N/m, accepted {:g} … {:g}", request.value, low, high)};
    next.max_stiffness_N_per_m = std::clamp(request.value, low, high);
  } else {
    if (!has_drag_) return {.done = false, .reason = "drag: the impedance law has no virtual tool"};
    const double low = MinDrag(own_), high = kMaxDragFactor * low;
    if (!IsWithin(request.value, low, high))
      return {
          .done = false,
          .reason = fmt::format("drag: found {:g} N s/m, accepted {:g} … {:g}", request.value, low, high)};
    const double factor = std::clamp(request.value, low, high) / low;
    next.damping_Ns_per_m.x = factor * own_.damping_Ns_per_m.x;
    next.damping_Ns_per_m.y = factor * own_.damping_Ns_per_m.y;
    next.damping_Ns_per_m.z = factor * own_.damping_Ns_per_m.z;
  }
  if (former_.size() == kMaxFormer) former_.erase(former_.begin());
  former_.push_back(present_);
  present_ = next;
  asked_ = true;
  return {.done = true, .reason = ""};
}

std::optional<control::Gains> GainsPanel::Take() {
  const std::lock_guard lock(mutex_);
  if (!asked_) return std::nullopt;
  asked_ = false;
  return present_;
}

void GainsPanel::SetPresent(const control::Gains& gains) {
  const std::lock_guard lock(mutex_);
  present_ = gains;
  former_.clear();
  asked_ = false;
}

// Whether the present gains have at least the stability margin of the cell's own gains. This holds if they
// differ from these only by a softer coupling or a larger drag.
bool GainsPanel::KeepsOwnMargin() const {
  // after stiffness and drag are set to the cell's own, all gains must be equal to the cell's own
  control::Gains as_own = present_;
  as_own.max_stiffness_N_per_m = own_.max_stiffness_N_per_m;
  as_own.damping_Ns_per_m = own_.damping_Ns_per_m;
  std::vector<double> present, unchanged;
  const auto append_to = [](std::vector<double>& values) {
    return [&values](const char*, const char*, const char*, const double& value) { values.push_back(value); };
  };
  control::VisitGains(as_own, append_to(present));
  control::VisitGains(own_, append_to(unchanged));
  const PlainVector3 &d = present_.damping_Ns_per_m, &own = own_.damping_Ns_per_m;
  return present == unchanged && present_.max_stiffness_N_per_m <= own_.max_stiffness_N_per_m &&
         d.x >= own.x && d.y >= own.y && d.z >= own.z;
}

nlohmann::json GainsPanel::TuneJson() const {
  if (!tune_) return nullptr;
  const auto or_null = [](const std::optional<double>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
  };
  nlohmann::json json{
      {"file", tune_->file},
      {"asked_margin", tune_->asked_margin},
      {"margin", KeepsOwnMargin() ? nlohmann::json(tune_->own_margin) : nlohmann::json(nullptr)},
      {"worst_age_ms", 1e3 * tune_->worst_age_s},
      {"wall_N_per_m", KeepsOwnMargin() ? or_null(tune_->WallAt(present_.damping_Ns_per_m.z)) : nullptr},
      {"recommended", nullptr}};
  if (const auto& recommended = tune_->recommended)
    json["recommended"] = {{"mass_kg", or_null(recommended->mass_kg)},
                           {"stiffness_N_per_m", or_null(recommended->stiffness_N_per_m)},
                           {"drag_Ns_per_m", recommended->drag_Ns_per_m},
                           {"margin", recommended->margin}};
  return json;
}

std::string GainsPanel::Json() const {
  const std::lock_guard lock(mutex_);
  const double drag = MinDrag(present_), own_drag = MinDrag(own_);
  // with this drag, contact planes are stable up to an age of drag over stiffness
  const double turning_N_per_m = std::min(present_.max_stiffness_N_per_m, planes_N_per_m_);
  const nlohmann::json json{{"type", "gains"},
                            {"stiffness_N_per_m", present_.max_stiffness_N_per_m},
                            {"min_stiffness_N_per_m", kMinStiffnessShare * own_.max_stiffness_N_per_m},
                            {"own_stiffness_N_per_m", own_.max_stiffness_N_per_m},
                            {"has_drag", has_drag_},
                            {"drag_Ns_per_m", drag},
                            {"own_drag_Ns_per_m", own_drag},
                            {"max_drag_Ns_per_m", kMaxDragFactor * own_drag},
                            {"stable_age_ms", 1e3 * drag / turning_N_per_m},
                            {"can_undo", !former_.empty()},
                            {"tune", TuneJson()},
                            {"tune_why", tune_ ? "" : tune_.error()}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace osteon::session
