// The NativeScript class OsteonSession (base Reference): osteon_host.h for GDScript, in Godot's axes.
//
// A method that can fail returns a String: empty, or what was found and what is accepted. force() and
// figures(), surface_changes() and next_event() return zero, null or nothing instead; last_error() then has
// the text.
#include <exception>
#include <string>
#include <vector>

#include "plugin/godot/src/godot_values.h"

namespace osteon::godot {
namespace {

const godot_gdnative_ext_nativescript_api_struct* nativescript = nullptr;

class GodotSession {
 public:
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
      Succeeds(session_.SetToolPose(arguments.PoseAt(0), Spindle(arguments.BoolAt(1))));
    return Value(error_);
  }

  Value Step(const Arguments& arguments) {
    if (Succeeds(arguments.Mismatch(
            "step", {GODOT_VARIANT_TYPE_TRANSFORM, GODOT_VARIANT_TYPE_BOOL, GODOT_VARIANT_TYPE_REAL})))
      Succeeds(session_.Step(arguments.PoseAt(0), Spindle(arguments.BoolAt(1)), arguments.RealAt(2)));
    return Value(error_);
  }

  Value Force(const Arguments& arguments) {
    host::Wrench wrench;
    if (Succeeds(arguments.Mismatch("force", {GODOT_VARIANT_TYPE_TRANSFORM})))
      Succeeds(session_.Evaluate(arguments.PoseAt(0), &wrench));
    ArrayBuilder result;
    result.Add(Value(wrench.force_N));
    result.Add(Value(wrench.torque_Nm));
    return result.ToValue();
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
    return Value(error_);
  }

  Value Mark(const Arguments& /*arguments*/) {
    Succeeds(osteon_session_mark(session_.session()));
    return Value(error_);
  }

  Value Undo(const Arguments& arguments) {
    if (Succeeds(arguments.Mismatch("undo", {GODOT_VARIANT_TYPE_TRANSFORM})))
      Succeeds(session_.Undo(arguments.PoseAt(0)));
    return Value(error_);
  }

  Value LastError(const Arguments& /*arguments*/) { return Value(error_); }

  std::string Keep(const std::string& text) { return error_ = text; }

 private:
  double Spindle(bool spins) const { return spins ? session_.spindle_rad_per_s() : 0.0; }

  bool Succeeds(const std::string& mismatch) {
    error_ = mismatch;
    return mismatch.empty();
  }
  bool Succeeds(OsteonResult result) {
    if (result == OSTEON_OK)
      error_.clear();
    else if (!session_.IsOpen())
      error_ = "the session is not open: call open() first";
    else
      error_ = osteon_last_error();
    return result == OSTEON_OK;
  }

  std::string OpenWith(const godot_variant* given) {
    std::string scene, tool, config_folder, engine = "auto";
    host::SessionParams params;
    const auto take = [&](const std::string& key, const godot_variant* value) -> std::string {
      const godot_variant_type found = api->godot_variant_get_type(value);
      const bool is_number = found == GODOT_VARIANT_TYPE_REAL || found == GODOT_VARIANT_TYPE_INT;
      const auto expected = [&](const char* type) {
        return key + ": found " + TypeName(found) + ", accepted a " + type;
      };
      for (auto& [name, text] : {std::pair<const char*, std::string*>{"scene", &scene},
                                 {"tool", &tool},
                                 {"config_folder", &config_folder},
                                 {"engine", &engine}})
        if (key == name) {
          if (found != GODOT_VARIANT_TYPE_STRING) return expected("String");
          *text = ToText(value);
          return {};
        }
      for (auto& [name, number] : {std::pair<const char*, double*>{"diameter_m", &params.diameter_m},
                                   {"max_force_N", &params.max_force_N}})
        if (key == name) {
          if (!is_number) return expected("float");
          *number = api->godot_variant_as_real(value);
          return {};
        }
      if (key != "lockstep")
        return "open: found the key '" + key +
               "', accepted scene, tool, diameter_m, config_folder, engine, max_force_N, lockstep";
      if (found != GODOT_VARIANT_TYPE_BOOL) return expected("bool");
      params.lockstep = api->godot_variant_as_bool(value);
      return {};
    };

    godot_dictionary values = api->godot_variant_as_dictionary(given);
    godot_array keys = api->godot_dictionary_keys(&values);
    std::string wrong;
    for (int i = 0; wrong.empty() && i < api->godot_array_size(&keys); ++i) {
      godot_variant key = api->godot_array_get(&keys, i);
      godot_variant value = api->godot_dictionary_get(&values, &key);
      wrong = take(ToText(&key), &value);
      api->godot_variant_destroy(&value);
      api->godot_variant_destroy(&key);
    }
    api->godot_array_destroy(&keys);
    api->godot_dictionary_destroy(&values);
    if (!wrong.empty()) return wrong;

    if (engine == "cpu")
      params.engine = OSTEON_ENGINE_CPU;
    else if (engine == "vulkan")
      params.engine = OSTEON_ENGINE_VULKAN;
    else if (engine != "auto")
      return "engine: found '" + engine + "', accepted auto, cpu or vulkan";
    const auto or_null = [](const std::string& text) { return text.empty() ? nullptr : text.c_str(); };
    params.scene = or_null(scene);
    params.tool = or_null(tool);
    params.config_folder = or_null(config_folder);
    return session_.Open(params) == OSTEON_OK ? "" : osteon_last_error();
  }

  host::Session session_{host::kGodot};
  std::string error_;
};

GDCALLINGCONV void* Create(godot_object* /*instance*/, void* /*data*/) {
  try {
    return new GodotSession;
  } catch (const std::exception&) {
    return nullptr;
  }
}

GDCALLINGCONV void Destroy(godot_object* /*instance*/, void* /*data*/, void* session) {
  delete static_cast<GodotSession*>(session);
}

/// No exception crosses into Godot.
template <Value (GodotSession::*kMethod)(const Arguments&)>
GDCALLINGCONV godot_variant Call(godot_object* /*instance*/, void* /*data*/, void* session, int count,
                                 godot_variant** values) {
  auto* const self = static_cast<GodotSession*>(session);
  if (!self) return Value(std::string("no memory")).Release();
  try {
    return (self->*kMethod)(Arguments(count, values)).Release();
  } catch (const std::exception& error) {
    return Value(self->Keep(error.what())).Release();
  }
}

template <Value (GodotSession::*kMethod)(const Arguments&)>
void Register(void* handle, const char* name) {
  nativescript->godot_nativescript_register_method(
      handle, "OsteonSession", name, {GODOT_METHOD_RPC_MODE_DISABLED},
      {.method = &Call<kMethod>, .method_data = nullptr, .free_func = nullptr});
}

}  // namespace
}  // namespace osteon::godot

extern "C" {

void GDN_EXPORT godot_gdnative_init(godot_gdnative_init_options* options) {
  osteon::godot::api = options->api_struct;
  for (unsigned int i = 0; i < osteon::godot::api->num_extensions; ++i)
    if (osteon::godot::api->extensions[i]->type == GDNATIVE_EXT_NATIVESCRIPT)
      osteon::godot::nativescript = reinterpret_cast<const godot_gdnative_ext_nativescript_api_struct*>(
          osteon::godot::api->extensions[i]);
}

void GDN_EXPORT godot_gdnative_terminate(godot_gdnative_terminate_options* /*options*/) {
  osteon::godot::api = nullptr;
  osteon::godot::nativescript = nullptr;
}

void GDN_EXPORT godot_nativescript_init(void* handle) {
  using osteon::godot::GodotSession;
  using osteon::godot::Register;
  osteon::godot::nativescript->godot_nativescript_register_class(
      handle, "OsteonSession", "Reference",
      {.create_func = &osteon::godot::Create, .method_data = nullptr, .free_func = nullptr},
      {.destroy_func = &osteon::godot::Destroy, .method_data = nullptr, .free_func = nullptr});
  Register<&GodotSession::Open>(handle, "open");
  Register<&GodotSession::Close>(handle, "close");
  Register<&GodotSession::IsOpen>(handle, "is_open");
  Register<&GodotSession::Engine>(handle, "engine");
  Register<&GodotSession::Approach>(handle, "approach");
  Register<&GodotSession::SetToolPose>(handle, "set_tool_pose");
  Register<&GodotSession::Step>(handle, "step");
  Register<&GodotSession::Force>(handle, "force");
  Register<&GodotSession::Figures>(handle, "figures");
  Register<&GodotSession::NextEvent>(handle, "next_event");
  Register<&GodotSession::SurfaceChanges>(handle, "surface_changes");
  Register<&GodotSession::SurfaceWait>(handle, "surface_wait");
  Register<&GodotSession::Mark>(handle, "mark");
  Register<&GodotSession::Undo>(handle, "undo");
  Register<&GodotSession::LastError>(handle, "last_error");
}
}
