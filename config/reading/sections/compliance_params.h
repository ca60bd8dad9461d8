#pragma once

#include <optional>
#include <span>
#include <string>

#include "control/compliance/compliance.h"
#include "simulation/bone/material.h"
#include "simulation/tools/tool.h"
#include "simulation/tools/tool_compliance.h"

// Makes the parameters of compliant parts from the files of tools and materials, and checks the rules that
// keep the loop with these parts stable. Source of the rules: docs/theory/compliance.md.

namespace osteon::config {

/// The refusal of a parameter that violates a rule.
struct ComplianceRefusal {
  const char* key;   ///< "tool", "layer", or a key of `bone_mount`
  std::string text;  ///< what was found, what is accepted and why
};

/// Makes the loop's parameters of a tool that bends. The compliance grows with the thrust P by the factor 1 /
/// (1 - P / P_cr), with the buckling load P_cr. It is used at P = push_N.
/// @param relaxation_s  time constant of the bending
/// @param push_N  largest thrust along the feed, below the buckling load
[[nodiscard]] control::ToolLinkParams ToolLinkOf(const simulation::ToolCompliance& tool, double relaxation_s,
                                                 double push_N);

/// Makes the loop's layer: the stiffness of each material's layer, with the thickness and time constant of
/// the softest one. HasLayer tells whether any material has a layer.
/// @param engaged_layer_m  as in the engine's cutting parameters
[[nodiscard]] control::SurfaceLayerParams SurfaceLayerOf(std::span<const simulation::Material> materials,
                                                         const simulation::Tool& tool,
                                                         double engaged_layer_m);
[[nodiscard]] bool HasLayer(const control::SurfaceLayerParams& layer);

/// Secant compliance of a layer's softest material at a first touch [m/N]: indentation divided by force.
[[nodiscard]] double LayerCompliance(const control::SurfaceLayerParams& layer, double force_N);

/// Tangent stiffness k_t = dF/ddelta of a layer's softest material at a first touch [N/m], with force F and
/// indentation delta. The bound of the indentation at 0.4 of the thickness is ignored.
[[nodiscard]] double LayerTangent_N_per_m(const control::SurfaceLayerParams& layer, double force_N);

/// Area that a tool's head engages when it is seated [m²], with the head's radius R and the engaged layer e:
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

/// Refuses a tool that is pushed with more than half of its buckling load, that has a natural frequency below
/// 100 Hz, or whose bending has a time constant below 20 ms. @returns nothing if the tool is accepted
[[nodiscard]] std::optional<ComplianceRefusal> CheckToolLink(const simulation::ToolCompliance& tool,
                                                             double relaxation_s, double push_N);

/// Rule 1: the sum of T K c / tau over the massless elements (tool and layer) is at most 1/2, with the period
/// T, the coupling's stiffness K, and an element's compliance c and time constant tau. @returns nothing if
/// the rule holds
[[nodiscard]] std::optional<ComplianceRefusal> CheckMassless(const control::ComplianceParams& params,
                                                             double stiffness_N_per_m, double period_s);

/// Squared lever of a point about each axis of a mount [m²]. The lever is the point's distance from the axis.
[[nodiscard]] Vector3 SquaredLevers_m2(const control::BoneMountParams& mount, const Vector3& p_W_m);

/// Checks a mount by itself. Its own damping ratio must be at least 0.05 (part of rule 2), and w T at most
/// 0.4 for each of its six modes (rule 3). T is the period, K the coupling's stiffness, m and I are the
/// mount's mass and inertia, k and k_r its stiffnesses, and L is the lever of the site about the mode's axis:
///
///     w² = (K + k) / m along an axis,   w² = (K L² + k_r) / I about it
///
/// @param p_W_m  position of the site in W
[[nodiscard]] std::optional<ComplianceRefusal> CheckMountAlone(const control::BoneMountParams& mount,
                                                               double stiffness_N_per_m, double period_s,
                                                               const Vector3& p_W_m);

}  // namespace osteon::config
