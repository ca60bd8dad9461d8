// osteon_host_plan.h: a surgical plan in a host's axes: the planned cup, the guidance of a hand along the
// plan, and the score of the result. Header-only, C++17; failures are reported as in osteon_host.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "osteon_host.h"

namespace osteon {
namespace host {

struct PlanParams {
  const char* plan = nullptr;           ///< null: "acetabulum"
  const char* rubric = nullptr;         ///< null: the rubric of the plan's kind
  const char* config_folder = nullptr;  ///< as OsteonBoneParams has it
};

struct PlanInfo {
  Vector cup_center{};     ///< planned centre, in the host's axes and unit
  Vector cup_axis{};       ///< unit, out of the opening
  Vector native_center{};  ///< centre of the hip before the operation; NaN if the plan has none
  OsteonPlanInfo values;   ///< angles, diameter, numbers; positions in it are in Osteon's axes and metres
};

struct Reamer {
  double diameter_m{0.0};
  Vector center{};  ///< planned position of the head's centre, in the host's axes and unit
  Vector apex{};    ///< planned position of the tool's apex
};

struct Assessment {
  OsteonAssessment values;             ///< all figures; the centre in it is in Osteon's axes and metres
  Vector center{};                     ///< centre of the fitted sphere, in the host's axes and unit
  std::vector<OsteonScoreItem> items;  ///< the rubric's rows
};

/// A plan with its rubric; it never changes while it is open.
class Plan {
 public:
  explicit Plan(const Axes& axes) : axes_(axes) {}
  ~Plan() { Close(); }
  Plan(const Plan&) = delete;
  Plan& operator=(const Plan&) = delete;

  /// Closes what was open first.
  OsteonResult Open(const PlanParams& params) {
    Close();
    OsteonPlanParams given;
    const OsteonResult result = osteon_plan_params_init(OSTEON_ABI, &given);
    if (result != OSTEON_OK) return result;
    given.plan = params.plan;
    given.rubric = params.rubric;
    given.config_folder = params.config_folder;
    return osteon_plan_create(OSTEON_ABI, &given, &plan_);
  }

  void Close() {
    osteon_plan_destroy(plan_);
    plan_ = nullptr;
  }

  bool IsOpen() const { return plan_ != nullptr; }
  const Axes& axes() const { return axes_; }
  const OsteonPlan* plan() const { return plan_; }

  OsteonResult GetInfo(PlanInfo* info) const {
    const OsteonResult result = osteon_plan_info(plan_, &info->values);
    if (result != OSTEON_OK) return result;
    const OsteonPlanInfo& values = info->values;
    info->cup_center = PositionToHost(axes_, VectorOf(values.cup_center_m));
    info->cup_axis = DirectionToHost(axes_, VectorOf(values.cup_axis));
    info->native_center = PositionToHost(axes_, VectorOf(values.native_center_m));
    return result;
  }

  /// @param index  from 0, below reamer_count
  OsteonResult GetReamer(std::uint32_t index, Reamer* reamer) const {
    OsteonReamer found;
    const OsteonResult result = osteon_plan_reamer(plan_, index, &found);
    if (result != OSTEON_OK) return result;
    reamer->diameter_m = found.diameter_m;
    reamer->center = PositionToHost(axes_, VectorOf(found.center_m));
    reamer->apex = PositionToHost(axes_, VectorOf(found.apex_m));
    return result;
  }

  /// Compares a session's bone in its present state with this plan; takes about 0.1 s.
  OsteonResult Assess(const Session& session, Assessment* assessment) const {
    std::size_t count = 0;
    assessment->items.resize(kMaxItems);
    const OsteonResult result = osteon_session_assess(session.session(), plan_, &assessment->values,
                                                      assessment->items.data(), kMaxItems, &count);
    assessment->items.resize(result == OSTEON_OK ? count : 0);
    if (result == OSTEON_OK)
      assessment->center = PositionToHost(axes_, VectorOf(assessment->values.center_m));
    return result;
  }

 private:
  static constexpr std::size_t kMaxItems = 64;  // a rubric scores each metric once
  static Vector VectorOf(const double* v) { return {v[0], v[1], v[2]}; }

  Axes axes_;
  OsteonPlan* plan_{nullptr};
};

struct Guided {
  Wrench wrench;                ///< wrench of the guidance, to be added to the wrench of Session::Evaluate
  OsteonGuidanceOutput values;  ///< shares, distances, flags; the wrench in it is in Osteon's axes
};

/// The guidance that keeps a hand to a plan, for one of the plan's reamers. One thread at a time; wait-free
/// except for Open and Close.
class Guidance {
 public:
  explicit Guidance(const Axes& axes) : axes_(axes) {}
  ~Guidance() { Close(); }
  Guidance(const Guidance&) = delete;
  Guidance& operator=(const Guidance&) = delete;

  /// Closes an open guidance first. @param params  filled by osteon_guidance_params_init
  OsteonResult Open(const Plan& plan, const OsteonGuidanceParams& params) {
    Close();
    return osteon_guidance_create(OSTEON_ABI, plan.plan(), &params, &guidance_);
  }

  void Close() {
    osteon_guidance_destroy(guidance_);
    guidance_ = nullptr;
  }

  bool IsOpen() const { return guidance_ != nullptr; }

  /// Call it once per period. @param other  the wrench that is rendered besides the guidance (that of the
  /// bone); at the force limit it takes precedence over the guidance
  OsteonResult Evaluate(const Pose& pose, const Twist& twist, const Wrench& other, Guided* guided) {
    const OsteonPose X = PoseFromHost(axes_, pose);
    const OsteonTwist V = TwistFromHost(axes_, twist);
    const OsteonWrench F = WrenchFromHost(axes_, other);
    const OsteonResult result = osteon_guidance_evaluate(guidance_, &X, &V, &F, &guided->values);
    guided->wrench = WrenchToHost(axes_, guided->values.wrench);
    return result;
  }

  OsteonResult SetGain(double gain) { return osteon_guidance_set_gain(guidance_, gain); }
  OsteonResult SetModelAge(double age_s) { return osteon_guidance_set_model_age(guidance_, age_s); }
  OsteonResult Reset() { return osteon_guidance_reset(guidance_); }

 private:
  Axes axes_;
  OsteonGuidance* guidance_{nullptr};
};

}  // namespace host
}  // namespace osteon
