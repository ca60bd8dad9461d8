#include "control/guidance/guidance.h"

#include <algorithm>

namespace osteon::control {
namespace {

// Smallest stiffness for the check of the force's growth. A guidance may have only a cone; the stiffnesses of
// funnel and depth are then 0.
constexpr double kMinTripStiffness_N_per_m = 100.0;

const GuidanceParams& Validated(const GuidanceParams& params) {
  Validate(params);
  return params;
}

}  // namespace

Guidance::Guidance(const GuidanceParams& params, double max_speed_m_per_s, double period_s)
    : params_(Validated(params)),
      period_s_(period_s),
      growth_(std::max(kMinTripStiffness_N_per_m, params.lateral.stiffness + params.depth.stiffness),
              max_speed_m_per_s) {}

void Guidance::Reset() OSTEON_RT {
  growth_.Reset();
  field_ = {};
  scale_.Reset();
  stops_spindle_ = trips_ = false;
}

double Guidance::ProposeScale(const GuidanceInput& input) OSTEON_RT {
  field_ = EvaluateGuidance(params_, input.X_WT, input.V_WT);
  if (field_.beyond_stop) stops_spindle_ = params_.stops_spindle && params_.gain > 0.0;
  if (field_.inside || !(params_.gain > 0.0)) stops_spindle_ = false;
  return scale_.ProposeScale(field_, input.X_WT, std::min(params_.gain, input.model_fade), period_s_);
}

void Guidance::AcceptScale(double scale) OSTEON_RT {
  scale_.AcceptScale(scale);
  // Check only the springs' force. The damping depends on the velocity, which may change within a tick at a
  // contact.
  trips_ = growth_.Check(scale * field_.f_spring_W, period_s_);
}

GuidanceRecord Guidance::Record() const OSTEON_RT {
  return {.present = true,
          .F_T_W = scale_.F_T_W(),
          .share = scale_.scale(),
          .potential_J = field_.potential_J,
          .energy_J = scale_.energy_J(),
          .cone_rad = field_.excess.cone_rad,
          .lateral_m = field_.excess.lateral_m,
          .depth_m = field_.excess.depth_m,
          .stops_spindle = stops_spindle_};
}

}  // namespace osteon::control
