#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "plugin/godot/src/godot_errors.h"
#include "plugin/godot/src/godot_values.h"
#include "plugin/include/osteon_host_plan.h"

namespace osteon::godot {

/// Converts a text for osteon.h: an empty text becomes null, which means that no name is given.
inline const char* OrNull(const std::string& text) { return text.empty() ? nullptr : text.c_str(); }

inline host::Vector TripleOf(const double* values) { return {values[0], values[1], values[2]}; }

/// The NativeScript class OsteonSession (base Reference): osteon_host.h for GDScript, in Godot's axes.
///
/// A method that can fail returns a String: empty, or what was found and what is accepted. force(),
/// figures(), deflection(), assess(), surface_changes() and next_event() return zero, null or nothing if they
/// fail; last_error() then has the error's text.
class GodotSession final : public ErrorKeeper {
 public:
  GodotSession() : ErrorKeeper("the session is not open: call open() first") {}

  Value Open(const Arguments& arguments) {
    std::string text = arguments.Mismatch("open", {GODOT_VARIANT_TYPE_DICTIONARY});
    if (text.empty()) text = OpenWith(arguments.at(0));
    return Value(Keep(text));
  }

  Value Close(const Arguments& /*arguments*/) {
    session_.Close();
    return {};
  }

  Value IsOpen(const Arguments& /*arguments*/) { return Value::Bool(session_.IsOpen()); }

  Value Engine(const Arguments& /*arguments*/) {
    return Value(std::string(osteon_session_engine(session_.session())));
  }

  Value Approach(const Arguments& arguments) {
    host::Pose pose;
    if (!Succeeds(arguments.Mismatch("approach", {GODOT_VARIANT_TYPE_REAL}))) return {};
    if (!Succeeds(session_.Approach(arguments.RealAt(0), &pose))) return {};
    return Value(pose);
  }

  Value SetToolPose(const Arguments& arguments) {
    if (Succeeds(
            arguments.Mismatch("set_tool_pose", {GODOT_VARIANT_TYPE_TRANSFORM, GODOT_VARIANT_TYPE_BOOL})))
      Succeeds(session_.SetToolPose(arguments.PoseAt(0), SpindleSpeed(arguments.BoolAt(1))));
    return ErrorText();
  }

  Value Step(const Arguments& arguments) {
    if (Succeeds(arguments.Mismatch(
            "step", {GODOT_VARIANT_TYPE_TRANSFORM, GODOT_VARIANT_TYPE_BOOL, GODOT_VARIANT_TYPE_REAL})))
      Succeeds(session_.Step(arguments.PoseAt(0), SpindleSpeed(arguments.BoolAt(1)), arguments.RealAt(2)));
    return ErrorText();
  }

  /// force(pose) is for a tool at rest, force(pose, linear, angular) for a tool that moves.
  Value Force(const Arguments& arguments) {
    host::Wrench wrench;
    const std::string mismatch =
        arguments.count() <= 1
            ? arguments.Mismatch("force", {GODOT_VARIANT_TYPE_TRANSFORM})
            : arguments.Mismatch("force", {GODOT_VARIANT_TYPE_TRANSFORM, GODOT_VARIANT_TYPE_VECTOR3,
                                           GODOT_VARIANT_TYPE_VECTOR3});
    if (Succeeds(mismatch)) {
      host::Twist twist;
      if (arguments.count() > 1) twist = {arguments.VectorAt(1), arguments.VectorAt(2)};
      Succeeds(session_.Evaluate(arguments.PoseAt(0), twist, &wrench));
    }
    ArrayBuilder result;
    result.Add(Value(wrench.force_N));
    result.Add(Value(wrench.torque_Nm));
    return result.ToValue();
  }

  Value SetCompliance(const Arguments& arguments) {
    if (!Succeeds(arguments.Mismatch("set_compliance", {GODOT_VARIANT_TYPE_DICTIONARY}))) return ErrorText();
    OsteonComplianceParams params;
    if (!Succeeds(session_.DefaultCompliance(&params))) return ErrorText();
    bool tool = false, layer = false, mount = false;
    host::Vector point = TripleOf(params.mount_point_m), inertia = TripleOf(params.mount_inertia_kg_m2),
                 stiffness = TripleOf(params.mount_stiffness_N_per_m),
                 rotational = TripleOf(params.mount_stiffness_Nm_per_rad);
    if (Succeeds(ReadDictionary("set_compliance", arguments.at(0),
                                {{"tool", &tool},
                                 {"layer", &layer},
                                 {"mount", &mount},
                                 {"period_s", &params.period_s},
                                 {"push_N", &params.push_N},
                                 {"noticed_m", &params.noticed_m},
                                 {"mount_point_m", &point},
                                 {"mount_mass_kg", &params.mount_mass_kg},
                                 {"mount_inertia_kg_m2", &inertia},
                                 {"mount_stiffness_N_per_m", &stiffness},
                                 {"mount_stiffness_Nm_per_rad", &rotational},
                                 {"mount_damping_ratio", &params.mount_damping_ratio},
                                 {"mount_creep_N_per_m", &params.mount_creep_N_per_m},
                                 {"mount_creep_s", &params.mount_creep_s}}))) {
      params.tool = tool ? 1 : 0;
      params.layer = layer ? 1 : 0;
      params.mount = mount ? 1 : 0;
      std::copy(point.begin(), point.end(), params.mount_point_m);
      std::copy(inertia.begin(), inertia.end(), params.mount_inertia_kg_m2);
      std::copy(stiffness.begin(), stiffness.end(), params.mount_stiffness_N_per_m);
      std::copy(rotational.begin(), rotational.end(), params.mount_stiffness_Nm_per_rad);
      Succeeds(session_.SetCompliance(params));
    }
    return ErrorText();
  }

  Value Deflection(const Arguments& /*arguments*/) {
    host::Deflection found;
    if (!Succeeds(session_.GetDeflection(&found))) return {};
    DictionaryBuilder result;
    result.Set("head", Value(found.head));
    result.Set("bone", Value(found.bone));
    result.Set("bend_m", Value(found.bend));
    result.Set("bend_rad", Value(found.bend_rad));
    result.Set("layer_m", Value(found.layer));
    result.Set("mount_m", Value(found.mount));
    result.Set("mount_rad", Value(found.mount_rad));
    result.Set("gives_way", Value::Bool(found.gives_way));
    result.Set("noticed", Value::Bool(found.noticed));
    result.Set("beyond_limit", Value::Bool(found.beyond_limit));
    return result.ToValue();
  }

  Value ChangeTool(const Arguments& arguments) {
    if (Succeeds(arguments.Mismatch("change_tool", {GODOT_VARIANT_TYPE_STRING, GODOT_VARIANT_TYPE_REAL,
                                                    GODOT_VARIANT_TYPE_TRANSFORM}))) {
      const std::string name = arguments.TextAt(0);
      Succeeds(session_.ChangeTool(OrNull(name), arguments.RealAt(1), OrNull(config_folder_),
                                   arguments.PoseAt(2)));
    }
    return ErrorText();
  }

  Value Save(const Arguments& arguments) {
    if (Succeeds(arguments.Mismatch("save", {GODOT_VARIANT_TYPE_STRING})))
      Succeeds(session_.Save(arguments.TextAt(0).c_str()));
    return ErrorText();
  }

  Value Restore(const Arguments& arguments) {
    if (Succeeds(arguments.Mismatch("restore", {GODOT_VARIANT_TYPE_STRING, GODOT_VARIANT_TYPE_TRANSFORM})))
      Succeeds(session_.Restore(arguments.TextAt(0).c_str(), arguments.PoseAt(1)));
    return ErrorText();
  }

  /// Writes the surface in millimetres and Osteon's axes; the file name's ending selects the format.
  Value ExportSurface(const Arguments& arguments) {
    if (Succeeds(arguments.Mismatch("export_surface", {GODOT_VARIANT_TYPE_STRING})))
      Succeeds(osteon_session_surface_export(session_.session(), arguments.TextAt(0).c_str(), nullptr));
    return ErrorText();
  }

  /// assess(plan, rubric): each is a name or a file. An empty plan means "acetabulum", an empty rubric that
  /// of the plan's kind.
  Value Assess(const Arguments& arguments) {
    if (!Succeeds(arguments.Mismatch("assess", {GODOT_VARIANT_TYPE_STRING, GODOT_VARIANT_TYPE_STRING})))
      return {};
    const std::string name = arguments.TextAt(0), rubric = arguments.TextAt(1);
    host::Plan plan(session_.axes());
    host::Assessment found;
    if (!Succeeds(plan.Open({OrNull(name), OrNull(rubric), OrNull(config_folder_)})) ||
        !Succeeds(plan.Assess(session_, &found)))
      return {};
    const OsteonAssessment& values = found.values;
    DictionaryBuilder result;
    result.Set("score", Value(values.score));
    result.Set("axis_error_rad", Value(values.axis_error_rad));
    result.Set("diameter_m", Value(values.diameter_m));
    result.Set("center", Value(found.center));
    result.Set("coverage", Value(values.coverage));
    result.Set("removed_mm3", Value(1e9 * values.removed_m3));
    result.Set("over_mm3", Value(1e9 * values.over_m3));
    result.Set("under_mm3", Value(1e9 * values.under_m3));
    result.Set("min_wall_m", Value(values.min_wall_m));
    ArrayBuilder items;
    for (const OsteonScoreItem& item : found.items) {
      DictionaryBuilder row;
      row.Set("metric", Value(std::string(item.metric)));
      row.Set("unit", Value(std::string(item.unit)));
      row.Set("value", Value(item.value));
      row.Set("full", Value(item.full));
      row.Set("zero", Value(item.zero));
      row.Set("weight", Value(item.weight));
      row.Set("points", Value(item.points));
      items.Add(row.ToValue());
    }
    result.Set("items", items.ToValue());
    return result.ToValue();
  }

  Value Version(const Arguments& /*arguments*/) { return Value(std::string(osteon_version())); }

  /// The assumptions that were needed to make a solid from the bone's mesh; empty: none.
  Value BoneWarning(const Arguments& /*arguments*/) {
    return Value(std::string(osteon_bone_warning(session_.bone())));
  }

  Value Figures(const Arguments& /*arguments*/) {
    OsteonFigures figures;
    if (!Succeeds(osteon_session_figures(session_.session(), &figures))) return {};
    DictionaryBuilder result;
    result.Set("frame", Value(static_cast<std::int64_t>(figures.frame)));
    result.Set("contacts", Value(std::int64_t{figures.contacts}));
    result.Set("frame_time_s", Value(figures.frame_time_s));
    result.Set("pose_age_s", Value(figures.pose_age_s));
    result.Set("depth_m", Value(figures.depth_m));
    result.Set("removed_mm3", Value(1e9 * figures.removed_volume_m3));
    result.Set("removed_g", Value(1e3 * figures.removed_mass_kg));
    result.Set("cutting_work_J", Value(figures.cutting_work_J));
    result.Set("spindle_torque_Nm", Value(figures.spindle_torque_Nm));
    result.Set("proxy", Value(host::PoseToHost(session_.axes(), figures.proxy)));
    return result.ToValue();
  }

  Value NextEvent(const Arguments& /*arguments*/) {
    OsteonEvent event;
    const OsteonResult found = osteon_session_next_event(session_.session(), &event);
    if (found == OSTEON_EMPTY || !Succeeds(found)) return {};
    const double* p = event.position_m;
    DictionaryBuilder result;
    result.Set("name", Value(std::string(event.name)));
    result.Set("value_m", Value(event.value_m));
    result.Set("position", Value(host::PositionToHost(session_.axes(), {p[0], p[1], p[2]})));
    result.Set("frame", Value(static_cast<std::int64_t>(event.frame)));
    return result.ToValue();
  }

  Value SurfaceChanges(const Arguments& /*arguments*/) {
    std::vector<host::Brick> changed;
    Succeeds(session_.TakeChangedBricks(&changed));
    ArrayBuilder result;
    for (const host::Brick& brick : changed) {
      ArrayBuilder pair;
      pair.Add(Value(std::int64_t{brick.number}));
      pair.Add(Value::MeshArrays(brick));
      result.Add(pair.ToValue());
    }
    return result.ToValue();
  }

  Value SurfaceWait(const Arguments& /*arguments*/) {
    Succeeds(osteon_session_surface_wait(session_.session()));
    return ErrorText();
  }

  Value Mark(const Arguments& /*arguments*/) {
    Succeeds(osteon_session_mark(session_.session()));
    return ErrorText();
  }

  Value Undo(const Arguments& arguments) {
    if (Succeeds(arguments.Mismatch("undo", {GODOT_VARIANT_TYPE_TRANSFORM})))
      Succeeds(session_.Undo(arguments.PoseAt(0)));
    return ErrorText();
  }

 private:
  // The tool's usual spindle speed [rad/s] if the spindle spins, else 0.
  double SpindleSpeed(bool spins) const { return spins ? session_.spindle_rad_per_s() : 0.0; }

  [[nodiscard]] bool HasOpened() const override { return session_.IsOpen(); }

  // Opens the session with the values of a Dictionary. Returns an empty text, or the error.
  std::string OpenWith(const godot_variant* given) {
    std::string scene, tool, engine = "auto";
    config_folder_.clear();
    host::SessionParams params;
    const std::string wrong = ReadDictionary("open", given,
                                             {{"scene", &scene},
                                              {"tool", &tool},
                                              {"diameter_m", &params.diameter_m},
                                              {"config_folder", &config_folder_},
                                              {"engine", &engine},
                                              {"max_force_N", &params.max_force_N},
                                              {"lockstep", &params.lockstep}});
    if (!wrong.empty()) return wrong;
    if (engine == "cpu")
      params.engine = OSTEON_ENGINE_CPU;
    else if (engine == "vulkan")
      params.engine = OSTEON_ENGINE_VULKAN;
    else if (engine != "auto")
      return "engine: found '" + engine + "', accepted auto, cpu or vulkan";
    params.scene = OrNull(scene);
    params.tool = OrNull(tool);
    params.config_folder = OrNull(config_folder_);
    return session_.Open(params) == OSTEON_OK ? "" : osteon_last_error();
  }

  host::Session session_{host::kGodot};
  std::string config_folder_;
};

}  // namespace osteon::godot
