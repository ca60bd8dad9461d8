#pragma once

#include <optional>
#include <span>
#include <string>

#include "control/compliance/compliance.h"
#include "simulation/bone/material.h"
#include "simulation/tools/tool.h"
#include "simulation/tools/tool_compliance.h"

// Parameters of the parts that give way, from the files of tools and materials, and the rules that they have
// to keep. Source of the rules: docs/theory/compliance.md.

namespace osteon::config {

/// A rule that the parameters do not keep.
struct ComplianceRefusal {
  const char* key;   ///< "tool", "layer", or a key of `bone_mount`
  std::string text;  ///< what was found, what is accepted and why
};

/// How a tool bends in the loop. Its compliance grows with the thrust: 1 / (1 - P / P_cr).
/// @param relaxation_s  time constant of the bending
/// @param push_N  largest thrust along the feed, below the buckling load
[[nodiscard]] control::ToolLinkParams ToolLinkOf(const simulation::ToolCompliance& tool, double relaxation_s,
                                                 double push_N);

/// Makes the loop's layer: the stiffness of each material, and thickness and time constant of the softest
/// layer. If no material has a layer, HasLayer is false.
/// @param engaged_layer_m  as in the engine's cutting parameters
[[nodiscard]] control::SurfaceLayerParams SurfaceLayerOf(std::span<const simulation::Material> materials,
                                                         const simulation::Tool& tool,
                                                         double engaged_layer_m);
[[nodiscard]] bool HasLayer(const control::SurfaceLayerParams& layer);

/// Secant compliance of a layer at a first touch of its softest material [m/N].
[[nodiscard]] double LayerCompliance(const control::SurfaceLayerParams& layer, double force_N);

/// Tangent stiffness k_t = dF/ddelta of a layer at a first touch of its softest material [N/m], as a
/// hand feels it. The indentation's bound at 0.4 of the thickness is ignored.
[[nodiscard]] double LayerTangent_N_per_m(const control::SurfaceLayerParams& layer, double force_N);

/// Area that a tool's head engages where it is seated [m²], with R of the head and e the engaged layer:
///
///     in a cup      pi e / (1/R - 1/R_cup), at most A_max; A_max where the head is no smaller than the cup
///     elsewhere     pi e R, as at a first touch
///
/// @param cup_radius_m  of the cup that the tool goes into; 0: none
[[nodiscard]] double SeatedArea_m2(const control::SurfaceLayerParams& layer, const simulation::Tool& tool,
                                   double cup_radius_m);

/// Indentation at rest of a layer's softest material under a force on an engaged area [m].
/// @param area_m2  0: the area of a first touch
[[nodiscard]] double LayerDeflection_m(const control::SurfaceLayerParams& layer, double force_N,
                                       double area_m2);

/// A tool must not be pushed with more than half of its buckling load, vibrate by itself below 100 Hz, or
/// have a time constant below 20 ms.
[[nodiscard]] std::optional<ComplianceRefusal> CheckToolLink(const simulation::ToolCompliance& tool,
                                                             double relaxation_s, double push_N);

/// Rule 1: the sum of T K c / tau over the massless elements is at most 1/2.
[[nodiscard]] std::optional<ComplianceRefusal> CheckMassless(const control::ComplianceParams& params,
                                                             double stiffness_N_per_m, double period_s);

/// Square of the lever of a point about each axis of a mount [m²]: a turn about the axis by a small angle
/// moves the point by the lever times that angle.
[[nodiscard]] Vector3 SquaredLevers_m2(const control::BoneMountParams& mount, const Vector3& p_W_m);

/// A mount's own damping ratio must be at least 0.05 (of rule 2), and w T at most 0.4 for each of its six
/// modes (rule 3), with the lever L of the site about the mode's axis:
///
///     w² = (K + k) / m along an axis,   w² = (K L² + k_r) / I about it
///
/// @param p_W_m  the site, in W like the mount's place
[[nodiscard]] std::optional<ComplianceRefusal> CheckMountAlone(const control::BoneMountParams& mount,
                                                               double stiffness_N_per_m, double period_s,
                                                               const Vector3& p_W_m);

}  // namespace osteon::config
