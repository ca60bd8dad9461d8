#pragma once

#include <array>

#include "base/marker.h"
#include "control/compliance/compliant_link.h"
#include "kinematics/spatial.h"
#include "simulation/contact/contact_model.h"

namespace osteon::control {

/// Soft tissue on the bone's surface: cartilage, or a layer that a user describes. Modelled as a massless
/// element that moves the contact planes into the bone. Every field has a usable default.
struct SurfaceLayerParams {
  /// kappa of each material [N/m³]: pressure divided by indentation; 0: the material has no layer.
  std::array<double, simulation::kMaxMaterials> kappa_N_per_m3{};
  double thickness_m{2e-3};  ///< h: the indentation is at most 0.4 h; > 0
  double tau_s{0.2};         ///< time constant; > 0
  /// e: thickness by which the engine defines the engaged area (CuttingParams); > 0
  double engaged_layer_m{0.5e-3};
  double touch_area_m2{39e-6};  ///< engaged area at a first touch, pi R e with the head's radius R; > 0
  double max_area_m2{2e-3};     ///< A_max = pi reach²; > 0
};

/// The layer at the contacts of a frame.
struct LayerContact {
  double kappa_N_per_m3{0.0};  ///< weighted mean over the contacts with a layer; 0: no contact has one
  double share{0.0};           ///< share of the contacts with a layer in the total weight, 0 … 1
  double area_m2{0.0};         ///< engaged area
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const SurfaceLayerParams& params);

/// Evaluates the layer at the contacts of a model. Ignores a contact with an implausible weight or material.
[[nodiscard]] LayerContact LayerOf(const SurfaceLayerParams& params,
                                   const simulation::ContactModel& model) OSTEON_RT;

/// Indentation at rest under a force:
///
///     F = kappa (A_c/e) delta²                       up to delta_s = e A_max / (2 A_c)
///     F = kappa A_max (delta - delta_s / 2)          beyond
///     linear below 1 N, so that the stiffness at a first touch is not zero
///
/// A_c is the engaged area, at least that of a first touch. For a ball that touches a flat surface, A_c = pi
/// R e, which gives Winkler's F = pi kappa R delta². The indentation is multiplied by max(0, 2 share - 1),
/// with the layer's share of the contacts, and is at most 0.4 h.
/// @returns delta [m], >= 0
[[nodiscard]] double LayerIndentation(const SurfaceLayerParams& params, const LayerContact& contact,
                                      double force_N) OSTEON_RT;

/// Advances the layer's displacement q, in M, by one tick toward -delta(|f|) f / |f|.
/// @param f_M  force of the planes on the tool, in M
[[nodiscard]] Vector3 StepLayer(const SurfaceLayerParams& params, const LayerContact& contact,
                                const Vector3& f_M, double period_s, const Vector3& q_m) OSTEON_RT;

}  // namespace osteon::control
