#include <memory>
#include <optional>

#include "base/clock.h"
#include "plugin/src/compliance_levels.h"
#include "plugin/src/convert.h"
#include "plugin/src/engine_lock.h"
#include "plugin/src/session.h"

// The part of a session that handles compliance: it computes the wrench and the pose for the engine, and
// makes the compliant parts.

namespace osteon::plugin {

Wrench Session::Evaluate(const OsteonPose& pose, const OsteonTwist& twist) noexcept {
  const std::uint32_t beginnings = beginnings_.load(std::memory_order_acquire);
  if (beginnings != begun_) {  // another bone, tool or compliance: start from rest
    coupling_state_ = {};
    begun_ = beginnings;
    const Levels levels = levels_.Load();
    compliance_.reset();
    if (levels) compliance_.emplace(*levels);
  }
  const rt::Nanoseconds now = is_lockstep_ ? clock_.load(std::memory_order_relaxed) : rt::MonotonicNow();
  const bool spindle_turns = spindle_on_.load(std::memory_order_relaxed);
  const simulation::ContactModel& model = models_.Load();
  const Pose X_GT = ToPose(pose);
  const Twist V_GT = ToTwist(twist);
  if (!compliance_) {
    const control::CouplingOutput output = control::EvaluateCoupling(
        coupling_, {.model = model, .X_WT = X_GT, .V_WT = V_GT, .now = now, .spindle_turns = spindle_turns},
        coupling_state_);
    return limiter_.Limit(output.F_T_W).F;
  }
  const control::CouplingOutput output = control::EvaluateCoupling(coupling_,
                                                                   {.model = model,
                                                                    .X_WT = compliance_->X_ME(X_GT),
                                                                    .V_WT = compliance_->V_ME(X_GT, V_GT),
                                                                    .now = now,
                                                                    .spindle_turns = spindle_turns},
                                                                   coupling_state_);
  const safety::LimitedWrench limited = limiter_.Limit(compliance_->OnTool(output.F_T_W, X_GT));
  // the compliant parts are moved by the wrench of the contact planes, scaled as the limited wrench was
  const Wrench& planes = output.F_contact_T_W;
  compliance_->Step({.f = limited.share * planes.f, .t = limited.share * planes.t}, model, X_GT);
  Deflected deflected{.begun = begun_,
                      .noticed = compliance_->noticed(),
                      .beyond_limit = compliance_->beyond_limit(),
                      .record = {}};
  compliance_->FillRecord(X_GT, deflected.record);
  for_poses_.Store(deflected);
  for_figures_.Store(deflected);
  return limited.F;
}

Pose Session::InBone(const Pose& X_GT) noexcept {
  const Deflected& deflected = for_poses_.Load();
  return deflected.begun == beginnings_.load(std::memory_order_acquire) ? HeadInBone(deflected, X_GT) : X_GT;
}

Session::Levels Session::LevelsFor(const ToolSource& tool) {
  const CouplingFigures coupling{.stiffness_N_per_m = coupling_.max_stiffness_N_per_m,
                                 .engaged_layer_m = cutting_.engaged_layer_m};
  auto made = asked_ ? MakeCompliance(*asked_, *bone_, tool, coupling) : std::nullopt;
  if (!made) return nullptr;
  all_levels_.push_back(std::make_unique<const control::Compliance>(std::move(*made)));
  return all_levels_.back().get();
}

void Session::UseLevels(Levels levels) noexcept {
  levels_.Store(levels);
  beginnings_.fetch_add(1, std::memory_order_release);
}

void Session::SetCompliance(const OsteonComplianceParams* params) {
  const EngineLock lock(*this);
  const auto before = asked_;
  asked_ = params ? std::optional(*params) : std::nullopt;
  try {
    UseLevels(LevelsFor(*tool_));
  } catch (...) {
    asked_ = before;
    throw;
  }
}

OsteonDeflection Session::Deflection() {
  const EngineLock lock(*this);
  const Deflected& deflected = for_figures_.Load();
  return DeflectionOf(deflected.begun == beginnings_.load() ? deflected : Deflected{});
}

}  // namespace osteon::plugin
