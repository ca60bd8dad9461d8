#include "control/compliance/surface_layer.h"

#include <algorithm>
#include <cmath>

#include "base/parameter_check.h"

namespace osteon::control {
namespace {

constexpr double kLinearUpTo_N = 1.0;  // up to this force the indentation is proportional to the force
constexpr double kMaxShare = 0.4;  // indentation / thickness up to which the model of a linear layer is valid

// Indentation [m] at rest by the first two equations of LayerIndentation, without its fade and its bound.
// @param force_N  > 0
double WinklerIndentation(const SurfaceLayerParams& params, const LayerContact& contact,
                          double force_N) OSTEON_RT {
  const double area_m2 = std::clamp(contact.area_m2, params.touch_area_m2, params.max_area_m2);
  const double slope = contact.kappa_N_per_m3 * area_m2 / params.engaged_layer_m;
  const double delta_m = std::sqrt(force_N / slope);
  // delta_s of LayerIndentation: from this indentation on, the whole area max_area_m2 is in contact
  const double full_m = 0.5 * params.engaged_layer_m * params.max_area_m2 / area_m2;
  if (delta_m <= full_m) return delta_m;
  return force_N / (contact.kappa_N_per_m3 * params.max_area_m2) + 0.5 * full_m;
}

}  // namespace

void Validate(const SurfaceLayerParams& params) {
  const base::ParameterCheck require("compliance layer ");
  for (const double kappa : params.kappa_N_per_m3) require("kappa_N_per_m3", kappa, 0.0, 1e13);
  require("thickness_m", params.thickness_m, 1e-5, 0.1);
  require("tau_s", params.tau_s, 1e-3, 100.0);
  require("engaged_layer_m", params.engaged_layer_m, 1e-6, 0.01);
  require("touch_area_m2", params.touch_area_m2, 1e-9, params.max_area_m2);
  require("max_area_m2", params.max_area_m2, 1e-9, 1.0);
}

LayerContact LayerOf(const SurfaceLayerParams& params, const simulation::ContactModel& model) OSTEON_RT {
  LayerContact contact{.area_m2 = std::isfinite(model.engaged_area_m2) ? model.engaged_area_m2 : 0.0};
  double total_weight = 0.0, kappa = 0.0;
  for (int j = 0; j < std::clamp(model.contact_count, 0, simulation::kMaxContacts); ++j) {
    const simulation::Contact& c = model.contacts[static_cast<std::size_t>(j)];
    if (!(c.weight > 0.0 && c.weight <= 1.0) || c.material >= simulation::kMaxMaterials) continue;
    total_weight += c.weight;
    const double material_kappa = params.kappa_N_per_m3[c.material];
    if (!(material_kappa > 0.0)) continue;
    contact.share += c.weight;
    kappa += c.weight * material_kappa;
  }
  if (!(contact.share > 0.0)) return contact;
  contact.kappa_N_per_m3 = kappa / contact.share;
  contact.share /= total_weight;
  return contact;
}

double LayerIndentation(const SurfaceLayerParams& params, const LayerContact& contact,
                        double force_N) OSTEON_RT {
  const double fade = std::max(0.0, 2.0 * contact.share - 1.0);
  if (!(force_N > 0.0 && contact.kappa_N_per_m3 > 0.0 && fade > 0.0)) return 0.0;
  const double delta_m = force_N >= kLinearUpTo_N
                             ? WinklerIndentation(params, contact, force_N)
                             : force_N / kLinearUpTo_N * WinklerIndentation(params, contact, kLinearUpTo_N);
  return std::min(fade * delta_m, kMaxShare * params.thickness_m);
}

Vector3 StepLayer(const SurfaceLayerParams& params, const LayerContact& contact, const Vector3& f_M,
                  double period_s, const Vector3& q_m) OSTEON_RT {
  const double force_N = f_M.norm();
  Vector3 rest_m = Vector3::Zero();
  if (force_N > 0.0) rest_m = -LayerIndentation(params, contact, force_N) / force_N * f_M;
  return StepMassless<3>(q_m, rest_m, period_s, params.tau_s);
}

}  // namespace osteon::control
