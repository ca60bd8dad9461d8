#include "plugin/include/osteon.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "plugin/src/convert.h"
#include "plugin/src/handles.h"
#include "plugin/src/thread_pool.h"
#include "simulation/bone/material_style.h"
#include "simulation/solids/cup_frame.h"

// The functions of osteon.h: each checks its arguments, and turns exceptions into result codes.

using osteon::Pose;
using osteon::Vector3;
using osteon::plugin::BoneSource;
using osteon::plugin::CheckedPose;
using osteon::plugin::CheckPointer;
using osteon::plugin::Fail;
using osteon::plugin::Failure;
using osteon::plugin::Guarded;
using osteon::plugin::kForked;
using osteon::plugin::Session;
using osteon::plugin::ToolSource;
using osteon::plugin::WithSession;

// Programs compiled with ABI 1 call osteon_*_default with structs of these sizes, so these functions must
// never write more. If a struct grows, its _default function still fills the layout of ABI 1, and its _init
// function the new layout.
static_assert(sizeof(OsteonBoneParams) == 120 && sizeof(OsteonToolParams) == 48 &&
                  sizeof(OsteonSettings) == 56,
              "osteon_*_default fill the structs of ABI 1");
static_assert(std::string_view(OSTEON_VERSION) == OSTEON_PROJECT_VERSION,
              "osteon.h and CMakeLists.txt name the same version");

const char* osteon_version(void) { return OSTEON_VERSION; }
uint32_t osteon_abi(void) { return OSTEON_ABI; }
const char* osteon_last_error(void) { return osteon::plugin::LastError(); }

const char* osteon_result_text(OsteonResult result) {
  switch (result) {
    case OSTEON_OK:
      return "ok";
    case OSTEON_EMPTY:
      return "nothing waits";
    case OSTEON_ERROR_ARGUMENT:
      return "a value is out of range";
    case OSTEON_ERROR_FILE:
      return "a file cannot be used";
    case OSTEON_ERROR_MEMORY:
      return "no memory";
    case OSTEON_ERROR_DEVICE:
      return "the GPU cannot be used";
    case OSTEON_ERROR_STATE:
      return "not possible now";
    case OSTEON_ERROR_ABI:
      return "header and library do not fit";
    case OSTEON_ERROR_FORK:
      return "called in a forked child";
    case OSTEON_ERROR_BUFFER:
      return "a buffer is too small";
    case OSTEON_ERROR_INTERNAL:
      return "a defect of the library";
  }
  return "unknown result";
}

void osteon_bone_params_default(OsteonBoneParams* params) {
  if (params) *params = {};
}

OsteonResult osteon_bone_params_init(uint32_t abi, OsteonBoneParams* params) {
  return osteon::plugin::Init(abi, params, osteon_bone_params_default);
}

OsteonResult osteon_bone_create(uint32_t abi, const OsteonBoneParams* params, OsteonBone** bone) {
  if (bone) *bone = nullptr;
  return Guarded([&] {
    osteon::plugin::CheckAbi(abi);
    osteon::plugin::CheckProcess();
    CheckPointer(params, "params");
    CheckPointer(bone, "bone");
    osteon::plugin::KeepThreadPoolMapped();
    auto source = std::make_shared<const BoneSource>(osteon::plugin::MakeBone(*params));
    *bone = new OsteonBone{std::move(source)};
  });
}

void osteon_bone_destroy(OsteonBone* bone) { delete bone; }

const char* osteon_bone_warning(const OsteonBone* bone) { return bone ? bone->source->warning.c_str() : ""; }

OsteonResult osteon_bone_info(const OsteonBone* bone, OsteonBoneInfo* info) {
  return Guarded([&] {
    CheckPointer(bone, "bone");
    CheckPointer(info, "info");
    const osteon::simulation::Bone& from = bone->source->bone;
    const auto& c = from.site.center_m;
    const auto& a = from.site.axis;
    *info = {.balls = from.balls.size(),
             .mass_points = from.points.size(),
             .volume_m3 = 0.0,
             .mass_kg = 0.0,
             .site_center_m = {c.x, c.y, c.z},
             .site_axis = {a.x, a.y, a.z},
             .site_radius_m = from.site.radius_m,
             .material_count = static_cast<uint32_t>(from.materials.size())};
    for (const osteon::simulation::MassPoint& point : from.points) {
      info->volume_m3 += point.volume_m3;
      info->mass_kg += point.volume_m3 * from.materials[point.material].density_kg_per_m3;
    }
  });
}

const char* osteon_bone_material(const OsteonBone* bone, uint32_t index) {
  if (!bone || index >= bone->source->bone.materials.size()) return nullptr;
  return bone->source->bone.materials[index].name.c_str();
}

OsteonResult osteon_bone_material_color(const OsteonBone* bone, uint32_t index, uint8_t rgb[3]) {
  return Guarded([&] {
    CheckPointer(bone, "bone");
    CheckPointer(rgb, "rgb");
    const auto& materials = bone->source->bone.materials;
    if (index >= materials.size())
      throw Failure(OSTEON_ERROR_ARGUMENT,
                    fmt::format("index: found {}, accepted 0 … {}", index, materials.size() - 1));
    const auto& color =
        osteon::simulation::StyleOf(materials, static_cast<osteon::simulation::MaterialIndex>(index)).color;
    for (int i = 0; i < 3; ++i) rgb[i] = static_cast<uint8_t>(std::lround(255.0 * color[i]));
  });
}

OsteonResult osteon_bone_approach(const OsteonBone* bone, double height_m, OsteonPose* pose) {
  return Guarded([&] {
    CheckPointer(bone, "bone");
    CheckPointer(pose, "pose");
    if (!(std::abs(height_m) <= 1.0))
      throw Failure(OSTEON_ERROR_ARGUMENT, "height_m: found a number outside, accepted -1 … 1");
    Pose X_CT = Pose::Identity();  // the tool points into the bone, against the site's axis
    X_CT.linear() = Eigen::AngleAxisd(std::numbers::pi, Vector3::UnitX()).toRotationMatrix();
    X_CT.translation().z() = height_m;
    *pose = osteon::plugin::FromPose(osteon::simulation::CupPose(bone->source->bone.site) * X_CT);
  });
}

void osteon_tool_params_default(OsteonToolParams* params) {
  if (params) *params = {};
}

OsteonResult osteon_tool_params_init(uint32_t abi, OsteonToolParams* params) {
  return osteon::plugin::Init(abi, params, osteon_tool_params_default);
}

OsteonResult osteon_tool_create(uint32_t abi, const OsteonToolParams* params, OsteonTool** tool) {
  if (tool) *tool = nullptr;
  return Guarded([&] {
    osteon::plugin::CheckAbi(abi);
    osteon::plugin::CheckProcess();
    CheckPointer(params, "params");
    CheckPointer(tool, "tool");
    auto source = std::make_shared<const ToolSource>(osteon::plugin::MakeTool(*params));
    *tool = new OsteonTool{std::move(source)};
  });
}

void osteon_tool_destroy(OsteonTool* tool) { delete tool; }

double osteon_tool_spindle_rad_per_s(const OsteonTool* tool) {
  return tool ? tool->source->spindle_rad_per_s : 0.0;
}

void osteon_settings_default(OsteonSettings* settings) {
  if (settings)
    *settings = {.engine = OSTEON_ENGINE_AUTO,
                 .device = nullptr,
                 .lockstep = 0,
                 .surface = 1,
                 .max_force_N = 200.0,
                 .max_torque_Nm = 20.0,
                 .stiffness_N_per_m = 20e3,
                 .damping_Ns_per_m = 100.0};
}

OsteonResult osteon_settings_init(uint32_t abi, OsteonSettings* settings) {
  return osteon::plugin::Init(abi, settings, osteon_settings_default);
}

OsteonResult osteon_session_create(uint32_t abi, const OsteonBone* bone, const OsteonTool* tool,
                                   const OsteonSettings* settings, OsteonSession** session) {
  if (session) *session = nullptr;
  return Guarded([&] {
    osteon::plugin::CheckAbi(abi);
    osteon::plugin::CheckProcess();
    CheckPointer(bone, "bone");
    CheckPointer(tool, "tool");
    CheckPointer(session, "session");
    OsteonSettings chosen;
    osteon_settings_default(&chosen);
    if (settings) chosen = *settings;
    *session = new OsteonSession(bone->source, tool->source, chosen);
  });
}

void osteon_session_destroy(OsteonSession* session) {
  // In a forked child the session is not deleted: its threads do not exist there.
  if (session && !session->session.is_forked()) delete session;
}

const char* osteon_session_engine(const OsteonSession* session) {
  return session ? session->session.engine_text().c_str() : "";
}

OsteonResult osteon_session_set_log(OsteonSession* session, OsteonLogCallback callback, void* user) {
  return WithSession(session, [&](Session& s) { s.SetLog(callback, user); });
}

OsteonResult osteon_session_set_tool_pose(OsteonSession* session, const OsteonPose* pose,
                                          double spindle_rad_per_s) {
  if (!session || !pose)
    return Fail(OSTEON_ERROR_ARGUMENT, "session or pose: found null, accepted a pointer");
  if (session->session.is_forked()) return Fail(OSTEON_ERROR_FORK, kForked);
  if (session->session.is_lockstep())
    return Fail(OSTEON_ERROR_STATE,
                "set_tool_pose: the session is in lockstep, accepted osteon_session_step");
  if (!osteon::plugin::IsUsable(*pose) || !(std::abs(spindle_rad_per_s) < 1e6))
    return Fail(
        OSTEON_ERROR_ARGUMENT,
        "pose or spindle speed: found a number that is not finite or too large, or a quaternion of length 0, "
        "accepted finite numbers, positions within 1 km, speeds below 1e6 rad/s");
  session->session.SetToolPose(*pose, spindle_rad_per_s);
  return OSTEON_OK;
}

OsteonResult osteon_session_step(OsteonSession* session, const OsteonPose* pose, double spindle_rad_per_s,
                                 double dt_s) {
  return WithSession(session, [&](Session& s) {
    const Pose X_GT = CheckedPose(pose);
    if (!(std::abs(spindle_rad_per_s) < 1e6))
      throw Failure(OSTEON_ERROR_ARGUMENT, "spindle_rad_per_s: found a number outside, accepted below 1e6");
    s.Step(X_GT, spindle_rad_per_s, dt_s);
  });
}

OsteonResult osteon_session_evaluate(OsteonSession* session, const OsteonPose* pose, const OsteonTwist* twist,
                                     OsteonWrench* wrench) {
  if (wrench) *wrench = {};
  if (!session || !pose || !wrench)
    return Fail(OSTEON_ERROR_ARGUMENT, "session, pose or wrench: found null, accepted a pointer");
  if (session->session.is_forked()) return Fail(OSTEON_ERROR_FORK, kForked);
  const OsteonTwist rest{};
  const OsteonTwist& moving = twist ? *twist : rest;
  if (!osteon::plugin::IsUsable(*pose) || !osteon::plugin::IsFinite(moving))
    return Fail(
        OSTEON_ERROR_ARGUMENT,
        "pose or twist: found a number that is not finite, a position beyond 1 km, or a quaternion of length "
        "0, accepted finite numbers, positions within 1 km");
  *wrench = osteon::plugin::FromWrench(session->session.Evaluate(*pose, moving));
  return OSTEON_OK;
}

OsteonResult osteon_session_figures(OsteonSession* session, OsteonFigures* figures) {
  return WithSession(session, [&](Session& s) {
    CheckPointer(figures, "figures");
    *figures = s.Figures();
  });
}

OsteonResult osteon_session_next_event(OsteonSession* session, OsteonEvent* event) {
  bool is_empty = false;
  const OsteonResult result = WithSession(session, [&](Session& s) {
    CheckPointer(event, "event");
    const auto next = s.NextEvent();
    is_empty = !next;
    if (next) *event = *next;
  });
  return result == OSTEON_OK && is_empty ? OSTEON_EMPTY : result;
}

OsteonResult osteon_session_change_tool(OsteonSession* session, const OsteonTool* tool,
                                        const OsteonPose* pose) {
  return WithSession(session, [&](Session& s) {
    CheckPointer(tool, "tool");
    s.ChangeTool(tool->source, CheckedPose(pose));
  });
}

OsteonResult osteon_session_mark(OsteonSession* session) {
  return WithSession(session, [](Session& s) { s.Mark(); });
}

OsteonResult osteon_session_undo(OsteonSession* session, const OsteonPose* pose) {
  return WithSession(session, [&](Session& s) { s.Undo(CheckedPose(pose)); });
}

OsteonResult osteon_session_save(OsteonSession* session, const char* file) {
  return WithSession(session, [&](Session& s) {
    CheckPointer(file, "file");
    s.Save(file);
  });
}

OsteonResult osteon_session_restore(OsteonSession* session, const char* file, const OsteonPose* pose) {
  return WithSession(session, [&](Session& s) {
    CheckPointer(file, "file");
    s.Restore(file, CheckedPose(pose));
  });
}

OsteonResult osteon_session_surface_changes(OsteonSession* session, uint64_t* generation,
                                            OsteonSurfaceBuffers* buffers) {
  return WithSession(session, [&](Session& s) {
    CheckPointer(generation, "generation");
    CheckPointer(buffers, "buffers");
    s.mailbox().CopyChanges(*generation, *buffers);
  });
}

OsteonResult osteon_session_surface_wait(OsteonSession* session) {
  return WithSession(session, [](Session& s) { s.WaitForSurface(); });
}

OsteonResult osteon_session_surface_export(OsteonSession* session, const char* file,
                                           OsteonSurfaceInfo* info) {
  return WithSession(session, [&](Session& s) {
    CheckPointer(file, "file");
    const OsteonSurfaceInfo written = s.ExportSurface(file);
    if (info) *info = written;
  });
}
