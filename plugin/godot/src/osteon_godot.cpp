// The parts of the library that Godot uses: the entry points, and the NativeScript classes OsteonSession and
// OsteonGuidance.
#include <exception>
#include <string>

#include "plugin/godot/src/godot_guidance.h"
#include "plugin/godot/src/godot_session.h"

namespace osteon::godot {
namespace {

const godot_gdnative_ext_nativescript_api_struct* nativescript = nullptr;

template <class Class>
GDCALLINGCONV void* Create(godot_object* /*instance*/, void* /*data*/) {
  try {
    return new Class;
  } catch (const std::exception&) {
    return nullptr;
  }
}

template <class Class>
GDCALLINGCONV void Destroy(godot_object* /*instance*/, void* /*data*/, void* object) {
  delete static_cast<Class*>(object);
}

/// Calls a method for Godot. No exception may reach Godot, so an exception becomes a returned text.
template <class Class, auto kMethod>
GDCALLINGCONV godot_variant Call(godot_object* /*instance*/, void* /*data*/, void* object, int count,
                                 godot_variant** values) {
  auto* const self = static_cast<Class*>(object);
  if (!self) return Value(std::string("no memory")).Release();
  try {
    return (self->*kMethod)(Arguments(count, values)).Release();
  } catch (const std::exception& error) {
    return Value(self->Keep(error.what())).Release();
  }
}

/// Registers a NativeScript class and its methods.
template <class Class>
class NativeClass {
 public:
  NativeClass(void* handle, const char* name) : handle_(handle), name_(name) {
    nativescript->godot_nativescript_register_class(
        handle, name, "Reference",
        {.create_func = &Create<Class>, .method_data = nullptr, .free_func = nullptr},
        {.destroy_func = &Destroy<Class>, .method_data = nullptr, .free_func = nullptr});
  }
  template <auto kMethod>
  void Add(const char* method) {
    nativescript->godot_nativescript_register_method(
        handle_, name_, method, {GODOT_METHOD_RPC_MODE_DISABLED},
        {.method = &Call<Class, kMethod>, .method_data = nullptr, .free_func = nullptr});
  }

 private:
  void* handle_;
  const char* name_;
};

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
  using osteon::godot::GodotGuidance;
  using osteon::godot::GodotSession;
  osteon::godot::NativeClass<GodotSession> session(handle, "OsteonSession");
  session.Add<&GodotSession::Open>("open");
  session.Add<&GodotSession::Close>("close");
  session.Add<&GodotSession::IsOpen>("is_open");
  session.Add<&GodotSession::Engine>("engine");
  session.Add<&GodotSession::Approach>("approach");
  session.Add<&GodotSession::SetToolPose>("set_tool_pose");
  session.Add<&GodotSession::Step>("step");
  session.Add<&GodotSession::Force>("force");
  session.Add<&GodotSession::Figures>("figures");
  session.Add<&GodotSession::NextEvent>("next_event");
  session.Add<&GodotSession::SurfaceChanges>("surface_changes");
  session.Add<&GodotSession::SurfaceWait>("surface_wait");
  session.Add<&GodotSession::Mark>("mark");
  session.Add<&GodotSession::Undo>("undo");
  session.Add<&GodotSession::LastError>("last_error");
  session.Add<&GodotSession::SetCompliance>("set_compliance");
  session.Add<&GodotSession::Deflection>("deflection");
  session.Add<&GodotSession::ChangeTool>("change_tool");
  session.Add<&GodotSession::Save>("save");
  session.Add<&GodotSession::Restore>("restore");
  session.Add<&GodotSession::ExportSurface>("export_surface");
  session.Add<&GodotSession::Assess>("assess");
  session.Add<&GodotSession::BoneWarning>("bone_warning");
  session.Add<&GodotSession::Version>("version");
  osteon::godot::NativeClass<GodotGuidance> guidance(handle, "OsteonGuidance");
  guidance.Add<&GodotGuidance::Open>("open");
  guidance.Add<&GodotGuidance::Close>("close");
  guidance.Add<&GodotGuidance::IsOpen>("is_open");
  guidance.Add<&GodotGuidance::Info>("info");
  guidance.Add<&GodotGuidance::Evaluate>("evaluate");
  guidance.Add<&GodotGuidance::SetGain>("set_gain");
  guidance.Add<&GodotGuidance::SetModelAge>("set_model_age");
  guidance.Add<&GodotGuidance::Reset>("reset");
  guidance.Add<&GodotGuidance::LastError>("last_error");
}
}
