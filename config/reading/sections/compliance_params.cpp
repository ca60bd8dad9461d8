#include "config/reading/sections/compliance_params.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

namespace osteon::config {
namespace {

constexpr double kMinToolRelaxation_s = 0.020;  // shortest time constant of a tool's bending
constexpr double kMaxMasslessSum = 0.5;         // rule 1: largest sum of T K c / tau
constexpr double kMinDampingRatio = 0.05;       // rule 2: smallest damping ratio of a mount
constexpr double kMaxTurnPerTick = 0.4;         // rule 3: largest sqrt((K + k) / m) T of a mount [rad]
// smallest accepted natural frequency of a tool that is not in contact
constexpr double kMinFirstMode_hz = 100.0;
// the cell stops if a tool bends by more than this share of its free length
constexpr double kBendShare = 0.1;
constexpr double kThrustShare = 0.5;  // the cell stops if the thrust exceeds this share of the buckling load

// Radius of the tool's cutting head [m]; without a cutting head, of its first ball.
double HeadRadiusOf(const simulation::Tool& tool) {
  const simulation::ToolBall* head = simulation::CuttingHead(tool);
  return head ? head->radius_m : tool.balls.front().radius_m;
}

// Smallest stiffness of the materials that have a layer [N/m³]; 0: no material has a layer.
double SoftestOf(const control::SurfaceLayerParams& layer) {
  double softest = 0.0;
  for (const double kappa : layer.kappa_N_per_m3)
    if (kappa > 0.0) softest = softest > 0.0 ? std::min(softest, kappa) : kappa;
  return softest;
}

}  // namespace

control::ToolLinkParams ToolLinkOf(const simulation::ToolCompliance& tool, double relaxation_s,
                                   double push_N) {
  return {.compliance_T = simulation::ThrustFactor(push_N, tool.buckling_N) * tool.C_T,
          .tau_s = relaxation_s,
          .max_bend_m = kBendShare * tool.free_length_m,
          .max_thrust_N = kThrustShare * tool.buckling_N};
}

control::SurfaceLayerParams SurfaceLayerOf(std::span<const simulation::Material> materials,
                                           const simulation::Tool& tool, double engaged_layer_m) {
  control::SurfaceLayerParams layer;
  layer.engaged_layer_m = engaged_layer_m;
  const double reach_m = std::max(simulation::CuttingReach(tool), 1e-4);
  layer.max_area_m2 = std::numbers::pi * reach_m * reach_m;
  layer.touch_area_m2 =
      std::min(std::numbers::pi * HeadRadiusOf(tool) * layer.engaged_layer_m, layer.max_area_m2);
  double softest = 0.0;
  for (std::size_t i = 0; i < materials.size() && i < layer.kappa_N_per_m3.size(); ++i) {
    const simulation::Material& material = materials[i];
    layer.kappa_N_per_m3[i] = material.layer_N_per_m3;
    if (!(material.layer_N_per_m3 > 0.0) || (softest > 0.0 && material.layer_N_per_m3 >= softest)) continue;
    softest = material.layer_N_per_m3;
    layer.thickness_m = material.layer_thickness_m;
    layer.tau_s = material.layer_relaxation_s;
  }
  return layer;
}

bool HasLayer(const control::SurfaceLayerParams& layer) { return SoftestOf(layer) > 0.0; }

double LayerCompliance(const control::SurfaceLayerParams& layer, double force_N) {
  return LayerDeflection_m(layer, force_N, 0.0) / force_N;
}

double LayerTangent_N_per_m(const control::SurfaceLayerParams& layer, double force_N) {
  // relative step of the force, in both directions, for the difference quotient
  constexpr double kStep = 1e-4;
  // with an infinite thickness, the bound at 0.4 of the thickness never acts
  control::SurfaceLayerParams thick = layer;
  thick.thickness_m = std::numeric_limits<double>::infinity();
  const double further_m = LayerDeflection_m(thick, (1.0 + kStep) * force_N, 0.0) -
                           LayerDeflection_m(thick, (1.0 - kStep) * force_N, 0.0);
  return 2.0 * kStep * force_N / further_m;
}

double SeatedArea_m2(const control::SurfaceLayerParams& layer, const simulation::Tool& tool,
                     double cup_radius_m) {
  if (!(cup_radius_m > 0.0)) return layer.touch_area_m2;
  const double curvature_1_per_m = 1.0 / HeadRadiusOf(tool) - 1.0 / cup_radius_m;
  if (!(curvature_1_per_m > 0.0)) return layer.max_area_m2;
  return std::min(std::numbers::pi * layer.engaged_layer_m / curvature_1_per_m, layer.max_area_m2);
}

double LayerDeflection_m(const control::SurfaceLayerParams& layer, double force_N, double area_m2) {
  return control::LayerIndentation(
      layer, {.kappa_N_per_m3 = SoftestOf(layer), .share = 1.0, .area_m2 = area_m2}, force_N);
}

std::optional<ComplianceRefusal> CheckToolLink(const simulation::ToolCompliance& tool, double relaxation_s,
                                               double push_N) {
  if (!(push_N <= kThrustShare * tool.buckling_N))
    return ComplianceRefusal{
        "tool", fmt::format("found a push of {:.4g} N on a tool that buckles at {:.4g} N, accepted at most "
                            "half of that: push less, clamp more of the tool, or take a thicker one",
                            push_N, tool.buckling_N)};
  if (tool.first_mode_hz < kMinFirstMode_hz)
    return ComplianceRefusal{
        "tool", fmt::format("found a tool that vibrates at {:.4g} Hz by itself, accepted at least {:g}: its "
                            "head's mass is not in the model",
                            tool.first_mode_hz, kMinFirstMode_hz)};
  if (relaxation_s < kMinToolRelaxation_s)
    return ComplianceRefusal{"tool",
                             fmt::format("found a tool with relaxation_ms {:g}, accepted at least {:g}",
                                         1e3 * relaxation_s, 1e3 * kMinToolRelaxation_s)};
  return std::nullopt;
}

std::optional<ComplianceRefusal> CheckMassless(const control::ComplianceParams& c, double stiffness_N_per_m,
                                               double period_s) {
  const double TK = period_s * stiffness_N_per_m;
  const double tool_term =
      c.tool ? TK * c.tool->compliance_T.diagonal().head<3>().maxCoeff() / c.tool->tau_s : 0.0;
  const double layer_term = c.layer ? TK * LayerCompliance(*c.layer, 1.0) / c.layer->tau_s : 0.0;
  if (tool_term + layer_term <= kMaxMasslessSum) return std::nullopt;
  // Refuse the element with the larger term. The text names the time constant at which the sum would be
  // kMaxMasslessSum.
  const bool tool_worse = tool_term >= layer_term;
  const double min_tau_s = tool_worse
                               ? c.tool->tau_s * tool_term / std::max(1e-9, kMaxMasslessSum - layer_term)
                               : c.layer->tau_s * layer_term / std::max(1e-9, kMaxMasslessSum - tool_term);
  return ComplianceRefusal{
      tool_worse ? "tool" : "layer",
      fmt::format("found a {} of {:g} ms, accepted at least {:.4g}: period × coupling stiffness × "
                  "compliance / time constant may be {:g} in all, and is {:.3g}",
                  tool_worse ? "relaxation_ms" : "layer_relaxation_ms",
                  1e3 * (tool_worse ? c.tool->tau_s : c.layer->tau_s), 1e3 * min_tau_s, kMaxMasslessSum,
                  tool_term + layer_term)};
}

Vector3 SquaredLevers_m2(const control::BoneMountParams& mount, const Vector3& p_W_m) {
  const Vector3 r_m = p_W_m - mount.p_WMo_m;
  return Vector3::Constant(r_m.squaredNorm()) - r_m.cwiseAbs2();
}

std::optional<ComplianceRefusal> CheckMountAlone(const control::BoneMountParams& mount,
                                                 double stiffness_N_per_m, double period_s,
                                                 const Vector3& p_W_m) {
  if (mount.damping_ratio < kMinDampingRatio)
    return ComplianceRefusal{"damping_ratio", fmt::format("found {:g}, accepted at least {:g}",
                                                          mount.damping_ratio, kMinDampingRatio)};
  // smallest mass for each N/m of stiffness, by the limit kMaxTurnPerTick
  const double mass_per_stiffness = period_s * period_s / (kMaxTurnPerTick * kMaxTurnPerTick);
  const double min_mass_kg = (stiffness_N_per_m + mount.stiffness_N_per_m.maxCoeff()) * mass_per_stiffness;
  if (mount.mass_kg < min_mass_kg)
    return ComplianceRefusal{"mass_kg", fmt::format("found {:g}, accepted at least {:.4g}: with coupling and "
                                                    "mount it would turn further than {:g} rad in a period",
                                                    mount.mass_kg, min_mass_kg, kMaxTurnPerTick)};
  const Vector3 levers_m2 = SquaredLevers_m2(mount, p_W_m);
  const Vector3 min_inertia_kg_m2 =
      mass_per_stiffness * (stiffness_N_per_m * levers_m2 + mount.stiffness_Nm_per_rad);
  for (int axis = 0; axis < 3; ++axis)
    if (mount.inertia_kg_m2[axis] < min_inertia_kg_m2[axis])
      return ComplianceRefusal{
          "inertia_kg_m2",
          fmt::format(
              "found {:g} about {}, accepted at least {:.4g}: with the coupling at a lever of {:.4g} mm "
              "and the mount's {:g} N m/rad its swing would turn further than {:g} rad in a period",
              mount.inertia_kg_m2[axis], "xyz"[axis], min_inertia_kg_m2[axis],
              1e3 * std::sqrt(levers_m2[axis]), mount.stiffness_Nm_per_rad[axis], kMaxTurnPerTick)};
  return std::nullopt;
}

}  // namespace osteon::config
