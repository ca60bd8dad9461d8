#include "session/summary/limit_rows.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/units.h"
#include "control/arm/arm_speed_watch.h"
#include "safety/acting_limits.h"

namespace osteon::session {
namespace {

// The limits of safety::kLimitNames in words, in the same order.
constexpr std::array<std::string_view, safety::kLimitCount> kLimitTexts{"largest force or torque",
                                                                        "what the arm's joints can hold",
                                                                        "energy in the coupling's spring",
                                                                        "power into the hand",
                                                                        "tool speed",
                                                                        "workspace of the apex",
                                                                        "zones of flange and elbow",
                                                                        "joints",
                                                                        "elbow speed",
                                                                        "depth limit",
                                                                        "age of the contact model",
                                                                        "age of the force sensor's reading",
                                                                        "age governor",
                                                                        "passivity controller",
                                                                        "energy tank",
                                                                        "speed into bone at the force limit",
                                                                        "guidance along the plan",
                                                                        "deflection beyond the cell's error"};
static_assert(!kLimitTexts.back().empty(), "a limit without words");

// One of several bounds on a quantity, with its origin: "cell", "ceiling", "stored energy".
struct Bound {
  double value;
  std::string origin;
};

// Returns the tightest of several bounds on one quantity; the text names the other finite ones.
EffectiveLimit Tightest(std::string name, std::string unit, const std::vector<Bound>& bounds) {
  std::size_t tightest = 0;
  for (std::size_t i = 1; i < bounds.size(); ++i)
    if (bounds[i].value < bounds[tightest].value) tightest = i;
  std::string others;
  for (std::size_t i = 0; i < bounds.size(); ++i)
    if (i != tightest && std::isfinite(bounds[i].value))
      others += fmt::format("; {}: {:.4g}", bounds[i].origin, bounds[i].value);
  return {.name = std::move(name),
          .value = bounds[tightest].value,
          .unit = std::move(unit),
          .from = bounds[tightest].origin + others};
}

// Formats a limit: "force 200 N (cell; ceiling: 250)".
std::string Text(const EffectiveLimit& limit) {
  return fmt::format("{} {:.4g} {} ({})", limit.name, limit.value, limit.unit, limit.from);
}

std::string PlaceText(const Vector3& p_m) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) mm", 1e3 * p_m.x(), 1e3 * p_m.y(), 1e3 * p_m.z());
}

// Describes a zone, in the world's frame, and which point of tool or arm must be inside or outside of it.
std::string Text(const safety::ZoneParams& zone) {
  constexpr std::array<const char*, 5> kShapes{"half-space", "sphere", "box", "cylinder", "capsule"};
  constexpr std::array<const char*, 3> kPoints{"apex", "flange", "elbow"};
  const Vector3 axis = zone.R_W.col(2);
  std::string size;
  if (zone.shape == safety::ZoneShape::kBox)
    size = fmt::format(", {:.4g} × {:.4g} × {:.4g} mm", 2e3 * zone.half_edge_m.x(),
                       2e3 * zone.half_edge_m.y(), 2e3 * zone.half_edge_m.z());
  else if (zone.shape != safety::ZoneShape::kHalfSpace)
    size = fmt::format(", radius {:.4g} mm", 1e3 * zone.radius_m);
  if (zone.shape == safety::ZoneShape::kHalfSpace)
    size = fmt::format(", inward ({:.3g}, {:.3g}, {:.3g})", axis.x(), axis.y(), axis.z());
  return fmt::format("{} {} {} at {}{}", kPoints[static_cast<std::size_t>(zone.point)],
                     zone.side == safety::ZoneSide::kKeepIn ? "in" : "out of",
                     kShapes[static_cast<std::size_t>(zone.shape)], PlaceText(zone.p_W_m), size);
}

// Adds the limits at which a displacement of tool or mount stops the cell.
void AddDeflectionLimits(const control::ComplianceParams& p, std::vector<EffectiveLimit>& limits) {
  if (p.tool) {
    limits.push_back(
        Tightest("bend of the tool", "mm", {{1e3 * p.tool->max_bend_m, "tenth of its free length"}}));
    limits.push_back(
        Tightest("thrust on the tool", "N", {{p.tool->max_thrust_N, "half of its buckling load"}}));
  }
  if (p.mount) {
    limits.push_back(Tightest("shift of the bone's mount", "mm", {{1e3 * p.mount->max_shift_m, "fixed"}}));
    limits.push_back(Tightest("turn of the bone's mount", "rad", {{p.mount->max_turn_rad, "fixed"}}));
  }
}

}  // namespace

std::vector<EffectiveLimit> EffectiveLimits(const control::ServoParams& p, bool reduced) {
  const double infinite = std::numeric_limits<double>::infinity();
  const double reduced_mm_per_s = reduced ? 1e3 * control::kReducedSpeed_m_per_s : infinite;
  const double K = p.coupling.max_stiffness_N_per_m;
  const safety::WrenchRateTrip rate(K, p.twist.max_speed_m_per_s);
  const double force_N = control::ForceLimit_N(p);
  std::vector<EffectiveLimit> limits{
      Tightest("force", "N",
               {{p.wrench.max_force_N, "cell"},
                {safety::kForceCeiling_N, "ceiling"},
                {safety::ForceOfEnergy(p.energy.max_stored_J, K), "stored energy"}}),
      Tightest("torque", "N·m", {{p.wrench.max_torque_Nm, "cell"}}),
      Tightest("force that the hand may push", "N", {{force_N + p.sensor_force.margin_N, "force + margin"}}),
      Tightest("rate of the force", "N/s", {{rate.max_rate_N_per_s(), "1.5 K v_max"}}),
      Tightest(
          "tool speed", "mm/s",
          {{1e3 * p.twist.max_speed_m_per_s, "cell"},
           {1e3 * safety::SpeedOfEnergy(p.energy.max_kinetic_J, p.energy.moving_mass_kg), "kinetic energy"},
           {reduced_mm_per_s, "T1"}}),
      Tightest("measured tool speed", "mm/s",
               {{1e3 * control::ArmSpeedParams{}.margin * control::ToolSpeedLimit_m_per_s(p, false),
                 "1.5 × tool speed, and 1 mm beyond"}}),
      Tightest("tool turn", "deg/s", {{p.twist.max_turn_rad_per_s / kDegree, "cell"}}),
      Tightest("elbow speed", "mm/s", {{1e3 * p.max_elbow_speed_m_per_s, "cell"}, {reduced_mm_per_s, "T1"}}),
      Tightest("stored energy", "J", {{p.energy.max_stored_J, "cell"}}),
      Tightest("tool in bone", "mm", {{1e3 * p.on_force_limit.max_tool_in_bone_m, "cell"}}),
      Tightest("power into the hand", "W", {{p.energy.max_power_W, "cell"}}),
      Tightest("kinetic energy", "J", {{p.energy.max_kinetic_J, "cell"}}),
      Tightest("joint step", "deg", {{p.joints.jump_rad / kDegree, "cell"}}),
      Tightest("tracking error", "mm", {{1e3 * p.max_tracking_error_m, "cell"}}),
      Tightest("age of the contact model", "ms", {{1e3 * p.watchdog.model_stop_s, "cell"}}),
      Tightest("age of the force sensor", "ms", {{1e3 * p.watchdog.sensor_stop_s, "cell"}}),
      Tightest("spindle torque", "N·m", {{p.spindle_limits.max_torque_Nm, "cell"}}),
      Tightest("spindle speed", "rpm", {{p.spindle_limits.max_speed_rad_per_s / kRpm, "cell"}}),
  };
  for (int i = 0; i < 7; ++i) {
    const kinematics::JointLimits& joint = p.joints.limits[static_cast<std::size_t>(i)];
    if (!(joint.upper_rad > joint.lower_rad)) continue;  // a six-axis arm has no seventh joint
    limits.push_back(Tightest(fmt::format("A{} speed", i + 1), "deg/s",
                              {{p.joints.speed_share * joint.velocity_rad_per_s / kDegree, "arm × cell"}}));
    limits.push_back({.name = fmt::format("A{} position", i + 1),
                      .value = (joint.upper_rad - p.joints.position_margin_rad) / kDegree,
                      .unit = "deg",
                      .from = fmt::format("arm - margin; down to {:.4g}",
                                          (joint.lower_rad + p.joints.position_margin_rad) / kDegree)});
    if (p.arm_body && p.arm_body->has_masses)
      limits.push_back(Tightest(fmt::format("A{} torque", i + 1), "N·m",
                                {{p.arm_body->joints[static_cast<std::size_t>(i)].limits.torque_Nm,
                                  "arm; gravity's is in it, a message ahead"}}));
  }
  AddDeflectionLimits(p.compliance, limits);
  if (p.depth.acts)
    limits.push_back(
        Tightest("depth: resistance begins before the bound", "mm", {{1e3 * p.depth.soft_m, "cell"}}));
  return limits;
}

void ActedLimits::Add(const control::TickRecord& tick) {
  if (!start_) start_ = tick.stamp;
  const safety::LimitSet acting(tick.limits);
  for (std::size_t i = 0; i < safety::kLimitCount; ++i) {
    const auto limit = static_cast<safety::Limit>(i);
    if (acting.Has(limit) && counts_.Of(limit).ticks == 0) first_s_[i] = rt::ToSeconds(tick.stamp - *start_);
  }
  counts_.Count(acting);
}

std::vector<ActedLimit> ActedLimits::Rows(double period_s) const {
  std::vector<ActedLimit> acted;
  for (std::size_t i = 0; i < safety::kLimitCount; ++i) {
    const safety::LimitCount& count = counts_.Of(static_cast<safety::Limit>(i));
    if (count.ticks == 0) continue;
    acted.push_back({.name = std::string(safety::kLimitNames[i]),
                     .text = std::string(kLimitTexts[i]),
                     .ticks = count.ticks,
                     .events = count.events,
                     .first_s = first_s_[i],
                     .longest_s = period_s * static_cast<double>(count.longest),
                     .total_s = period_s * static_cast<double>(count.ticks)});
  }
  return acted;
}

nlohmann::json ToJson(const std::vector<EffectiveLimit>& effective, const std::vector<ActedLimit>& acted) {
  nlohmann::json in_force = nlohmann::json::array(), acted_rows = nlohmann::json::array();
  for (const EffectiveLimit& limit : effective)
    in_force.push_back(
        {{"name", limit.name},
         {"value", std::isfinite(limit.value) ? nlohmann::json(limit.value) : nlohmann::json(nullptr)},
         {"unit", limit.unit},
         {"from", limit.from}});
  for (const ActedLimit& limit : acted)
    acted_rows.push_back({{"name", limit.name},
                          {"ticks", limit.ticks},
                          {"events", limit.events},
                          {"first_s", limit.first_s},
                          {"longest_s", limit.longest_s}});
  return {{"effective", in_force}, {"acted", acted_rows}};
}

std::vector<std::string> LimitLines(const control::ServoParams& params) {
  std::vector<std::string> lines;
  for (const EffectiveLimit& limit : EffectiveLimits(params))
    if (std::isfinite(limit.value)) lines.push_back(Text(limit));
  const safety::WorkspaceParams& w = params.workspace;
  lines.push_back(Text(
      {.shape = safety::ZoneShape::kSphere, .p_W_m = w.sphere_center_W_m, .radius_m = w.sphere_radius_m}));
  lines.push_back(
      Text({.p_W_m = w.plane_offset_m * w.plane_normal_W, .R_W = RotationFromZTo(w.plane_normal_W)}));
  for (const safety::ZoneParams& zone : w.zones) lines.push_back(Text(zone));
  if (params.depth.acts) lines.push_back("depth limit: " + Text(safety::ZoneOf(params.depth)));
  return lines;
}

void PrintLimits(const control::ServoParams& params) {
  constexpr std::size_t kWidth = 110;  // length of a printed line in characters
  if (!params.has_interlock) fmt::print("Permission to move: {}.\n", kWithoutPlc);
  std::string line = "Limits in force:";
  for (const std::string& limit : LimitLines(params)) {
    if (line.size() + limit.size() > kWidth) {
      fmt::print("{}\n", line);
      line.assign(1, ' ');
    }
    line += fmt::format(" {};", limit);
  }
  line.back() = '.';
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

}  // namespace osteon::session
