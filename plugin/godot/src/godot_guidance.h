#pragma once

#include <string>

#include "plugin/godot/src/godot_errors.h"
#include "plugin/godot/src/godot_session.h"

namespace osteon::godot {

/// The NativeScript class OsteonGuidance (base Reference): a surgical plan, and the guidance that keeps a
/// hand to the plan, in Godot's axes. Methods report failures as those of OsteonSession do.
class GodotGuidance final : public ErrorKeeper {
 public:
  GodotGuidance() : ErrorKeeper("no plan is open: call open() first") {}

  Value Open(const Arguments& arguments) {
    std::string text = arguments.Mismatch("open", {GODOT_VARIANT_TYPE_DICTIONARY});
    if (text.empty()) text = OpenWith(arguments.at(0));
    if (!text.empty()) CloseBoth();
    return Value(Keep(text));
  }

  Value Close(const Arguments& /*arguments*/) {
    CloseBoth();
    return {};
  }

  Value IsOpen(const Arguments& /*arguments*/) { return Value::Bool(guidance_.IsOpen()); }

  /// The plan as a Dictionary: position of the cup, its angles [degrees], number of reamers.
  Value Info(const Arguments& /*arguments*/) {
    host::PlanInfo info;
    if (!Succeeds(plan_.GetInfo(&info))) return {};
    constexpr double kDegrees = 57.29577951308232;
    DictionaryBuilder result;
    result.Set("cup_center", Value(info.cup_center));
    result.Set("cup_axis", Value(info.cup_axis));
    result.Set("native_center", Value(info.native_center));
    result.Set("cup_diameter_m", Value(info.values.cup_diameter_m));
    result.Set("inclination_deg", Value(kDegrees * info.values.radiographic.inclination_rad));
    result.Set("anteversion_deg", Value(kDegrees * info.values.radiographic.anteversion_rad));
    result.Set("is_left", Value::Bool(info.values.is_left != 0));
    ArrayBuilder reamers;
    for (std::uint32_t i = 0; i < info.values.reamer_count; ++i) {
      host::Reamer found;
      if (!Succeeds(plan_.GetReamer(i, &found))) return {};
      DictionaryBuilder reamer;
      reamer.Set("diameter_m", Value(found.diameter_m));
      reamer.Set("center", Value(found.center));
      reamer.Set("apex", Value(found.apex));
      reamers.Add(reamer.ToValue());
    }
    result.Set("reamers", reamers.ToValue());
    return result.ToValue();
  }

  /// evaluate(pose, linear, angular, other_force, other_torque): call it once per period. other_force and
  /// other_torque are the wrench that OsteonSession.force returned. At the force limit this wrench takes
  /// precedence over the guidance.
  Value Evaluate(const Arguments& arguments) {
    constexpr auto kVector = GODOT_VARIANT_TYPE_VECTOR3;
    if (!Succeeds(arguments.Mismatch("evaluate",
                                     {GODOT_VARIANT_TYPE_TRANSFORM, kVector, kVector, kVector, kVector})))
      return {};
    host::Guided guided{};
    if (!Succeeds(guidance_.Evaluate(arguments.PoseAt(0), {arguments.VectorAt(1), arguments.VectorAt(2)},
                                     {arguments.VectorAt(3), arguments.VectorAt(4)}, &guided)))
      return {};
    const OsteonGuidanceOutput& values = guided.values;
    DictionaryBuilder result;
    result.Set("force", Value(guided.wrench.force_N));
    result.Set("torque", Value(guided.wrench.torque_Nm));
    result.Set("cone_rad", Value(values.cone_rad));
    result.Set("lateral_m", Value(values.lateral_m));
    result.Set("depth_m", Value(values.depth_m));
    result.Set("share", Value(values.share));
    result.Set("inside", Value::Bool(values.inside != 0));
    result.Set("stop_spindle", Value::Bool(values.stop_spindle != 0));
    result.Set("jumped", Value::Bool(values.jumped != 0));
    return result.ToValue();
  }

  Value SetGain(const Arguments& arguments) {
    if (Succeeds(arguments.Mismatch("set_gain", {GODOT_VARIANT_TYPE_REAL})))
      Succeeds(guidance_.SetGain(arguments.RealAt(0)));
    return ErrorText();
  }

  Value SetModelAge(const Arguments& arguments) {
    if (Succeeds(arguments.Mismatch("set_model_age", {GODOT_VARIANT_TYPE_REAL})))
      Succeeds(guidance_.SetModelAge(arguments.RealAt(0)));
    return ErrorText();
  }

  Value Reset(const Arguments& /*arguments*/) {
    Succeeds(guidance_.Reset());
    return ErrorText();
  }

 private:
  void CloseBoth() {
    guidance_.Close();
    plan_.Close();
  }

  [[nodiscard]] bool HasOpened() const override { return guidance_.IsOpen(); }

  // Opens plan and guidance with the values of a Dictionary. Returns an empty text, or the error.
  std::string OpenWith(const godot_variant* given) {
    std::string plan, rubric, config_folder;
    OsteonGuidanceParams params;
    if (osteon_guidance_params_init(OSTEON_ABI, &params) != OSTEON_OK) return osteon_last_error();
    std::string wrong = ReadDictionary("open", given,
                                       {{"plan", &plan},
                                        {"rubric", &rubric},
                                        {"config_folder", &config_folder},
                                        {"reamer", &params.reamer},
                                        {"gain", &params.gain},
                                        {"max_force_N", &params.max_force_N},
                                        {"max_torque_Nm", &params.max_torque_Nm},
                                        {"max_speed_m_per_s", &params.max_speed_m_per_s},
                                        {"period_s", &params.period_s}});
    if (!wrong.empty()) return wrong;
    const bool is_open = plan_.Open({OrNull(plan), OrNull(rubric), OrNull(config_folder)}) == OSTEON_OK &&
                         guidance_.Open(plan_, params) == OSTEON_OK;
    return is_open ? "" : osteon_last_error();
  }

  host::Plan plan_{host::kGodot};
  host::Guidance guidance_{host::kGodot};
};

}  // namespace osteon::godot
