// osteon_host.h: helpers for a game engine's plug-in in C++: a session in the engine's axes and units
// (osteon_host_axes.h), and the carved surface brick by brick; osteon_host_plan.h has plans and guidance.
// Header-only, C++17, throws no exception of its own. Every failure is returned as an OsteonResult;
// osteon_last_error() has its text.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "osteon_host_axes.h"

namespace osteon {
namespace host {

/// A brick's mesh in the host's axes and unit. If it has no vertices, the brick was removed.
struct Brick {
  std::uint32_t number{0};
  std::vector<float> positions, normals;  ///< x y z of each vertex
  /// red green blue of each vertex, sRGB; on a cut face multiplied by 0.85
  std::vector<std::uint8_t> colors;
  /// three per triangle, in the order for which the host draws the outside
  std::vector<std::int32_t> indices;
};

/// The displacements of the compliant parts (tool, tissue layer, bone mount), in the host's axes and unit.
struct Deflection {
  Pose head;                    ///< pose of the bent tool's head relative to the bone
  Pose bone;                    ///< pose at which to draw the bone
  Vector bend{}, bend_rad{};    ///< displacement of the tool's head, along the tool's axes
  Vector layer{};               ///< displacement of the tissue at the contact
  Vector mount{}, mount_rad{};  ///< displacement of the bone at the mount's point
  Vector mount_per_s{}, mount_rad_per_s{};
  /// compliance was on in the last Evaluate; false: it was off, and all displacements are zero
  bool gives_way{false};
  bool noticed{false};       ///< a displacement is larger than noticed_m
  bool beyond_limit{false};  ///< a displacement is larger than its limit: the caller should stop
};

/// Converts the mount's point and its values by axis to the host's axes. Stiffness and inertia about an axis
/// do not change their sign if the axis is mirrored.
inline OsteonComplianceParams ComplianceToHost(const Axes& axes, const OsteonComplianceParams& params) {
  OsteonComplianceParams host = params;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t from = axes.from[i];
    host.mount_point_m[i] = axes.sign[i] * params.mount_point_m[from];
    host.mount_inertia_kg_m2[i] = params.mount_inertia_kg_m2[from];
    host.mount_stiffness_N_per_m[i] = params.mount_stiffness_N_per_m[from];
    host.mount_stiffness_Nm_per_rad[i] = params.mount_stiffness_Nm_per_rad[from];
  }
  return host;
}

/// The inverse of ComplianceToHost.
inline OsteonComplianceParams ComplianceFromHost(const Axes& axes, const OsteonComplianceParams& host) {
  OsteonComplianceParams params = host;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t from = axes.from[i];
    params.mount_point_m[from] = axes.sign[i] * host.mount_point_m[i];
    params.mount_inertia_kg_m2[from] = host.mount_inertia_kg_m2[i];
    params.mount_stiffness_N_per_m[from] = host.mount_stiffness_N_per_m[i];
    params.mount_stiffness_Nm_per_rad[from] = host.mount_stiffness_Nm_per_rad[i];
  }
  return params;
}

inline Deflection DeflectionToHost(const Axes& axes, const OsteonDeflection& found) {
  const auto vector = [](const double* v) { return Vector{v[0], v[1], v[2]}; };
  Deflection deflection;
  deflection.head = PoseToHost(axes, found.head);
  deflection.bone = PoseToHost(axes, found.bone);
  deflection.bend = PositionToHost(axes, vector(found.bend_m));
  deflection.bend_rad = AxialToHost(axes, vector(found.bend_rad));
  deflection.layer = PositionToHost(axes, vector(found.layer_m));
  deflection.mount = PositionToHost(axes, vector(found.mount_m));
  deflection.mount_rad = AxialToHost(axes, vector(found.mount_rad));
  deflection.mount_per_s = PositionToHost(axes, vector(found.mount_m_per_s));
  deflection.mount_rad_per_s = AxialToHost(axes, vector(found.mount_rad_per_s));
  deflection.gives_way = found.gives_way != 0;
  deflection.noticed = found.noticed != 0;
  deflection.beyond_limit = found.beyond_limit != 0;
  return deflection;
}

struct SessionParams {
  const char* scene = nullptr;          ///< null: "acetabulum"
  const char* tool = nullptr;           ///< null: "reamer"
  double diameter_m = 0.0;              ///< 0: the tool's usual one
  const char* config_folder = nullptr;  ///< as OsteonBoneParams has it
  double max_force_N = 200.0;
  bool lockstep = false;
  OsteonEngine engine = OSTEON_ENGINE_AUTO;
};

/// A bone, a tool and their session, in the axes of a host. The rules for threads are those of osteon.h.
class Session {
 public:
  explicit Session(const Axes& axes) : axes_(axes) {}
  ~Session() { Close(); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Closes an open session first.
  OsteonResult Open(const SessionParams& params) {
    Close();
    const OsteonResult result = Create(params);
    if (result != OSTEON_OK) Close();  // Close leaves osteon_last_error() unchanged
    return result;
  }

  void Close() {
    osteon_session_destroy(session_);
    osteon_tool_destroy(tool_);
    osteon_bone_destroy(bone_);
    session_ = nullptr;
    tool_ = nullptr;
    bone_ = nullptr;
    generation_ = 0;
    colors_.clear();
  }

  bool IsOpen() const { return session_ != nullptr; }
  const Axes& axes() const { return axes_; }
  /// The session, for functions of osteon.h that this class does not wrap; null while no session is open.
  OsteonSession* session() const { return session_; }
  /// The bone; null while no session is open.
  const OsteonBone* bone() const { return bone_; }
  /// The tool's usual spindle speed [rad/s].
  double spindle_rad_per_s() const { return osteon_tool_spindle_rad_per_s(tool_); }

  /// Returns a pose of the tool that points into the site, as osteon_bone_approach. @param height_m  height
  /// of the apex over the site's centre; always in metres
  OsteonResult Approach(double height_m, Pose* pose) const {
    OsteonPose approach;
    const OsteonResult result = osteon_bone_approach(bone_, height_m, &approach);
    if (result == OSTEON_OK) *pose = PoseToHost(axes_, approach);
    return result;
  }

  /// Passes a pose to the engine's thread. Wait-free.
  OsteonResult SetToolPose(const Pose& pose, double spindle_rad_per_s) {
    const OsteonPose X = PoseFromHost(axes_, pose);
    return osteon_session_set_tool_pose(session_, &X, spindle_rad_per_s);
  }

  /// Computes one frame, for a session in lockstep.
  OsteonResult Step(const Pose& pose, double spindle_rad_per_s, double dt_s) {
    const OsteonPose X = PoseFromHost(axes_, pose);
    return osteon_session_step(session_, &X, spindle_rad_per_s, dt_s);
  }

  /// Computes the wrench on a tool at rest. Wait-free; the wrench is zero on failure.
  OsteonResult Evaluate(const Pose& pose, Wrench* wrench) { return Evaluate(pose, Twist(), wrench); }

  /// Computes the wrench on a moving tool, which includes the coupling's damping. Wait-free; the wrench is
  /// zero on failure.
  OsteonResult Evaluate(const Pose& pose, const Twist& twist, Wrench* wrench) {
    const OsteonPose X = PoseFromHost(axes_, pose);
    const OsteonTwist V = TwistFromHost(axes_, twist);
    OsteonWrench F;
    const OsteonResult result = osteon_session_evaluate(session_, &X, &V, &F);
    *wrench = WrenchToHost(axes_, F);
    return result;
  }

  /// Gets the collision-free pose of the tool in the newest frame. Returns OSTEON_EMPTY before the first
  /// frame.
  OsteonResult Proxy(Pose* pose) {
    OsteonFigures figures;
    const OsteonResult result = osteon_session_figures(session_, &figures);
    if (result == OSTEON_OK && figures.frame == 0) return OSTEON_EMPTY;
    if (result == OSTEON_OK) *pose = PoseToHost(axes_, figures.proxy);
    return result;
  }

  OsteonResult Undo(const Pose& pose) {
    const OsteonPose X = PoseFromHost(axes_, pose);
    return osteon_session_undo(session_, &X);
  }

  /// Saves the carved bone as osteon_session_save does.
  OsteonResult Save(const char* file) { return osteon_session_save(session_, file); }

  /// Returns to a saved bone. The tool's pose must be free of the saved bone.
  OsteonResult Restore(const char* file, const Pose& pose) {
    const OsteonPose X = PoseFromHost(axes_, pose);
    return osteon_session_restore(session_, file, &X);
  }

  /// Changes to another tool at `pose`, which must be free of bone. On failure the earlier tool stays in use.
  /// @param name  null: "reamer"   @param diameter_m  0: the tool's usual one
  OsteonResult ChangeTool(const char* name, double diameter_m, const char* config_folder, const Pose& pose) {
    OsteonTool* tool = nullptr;
    OsteonResult result = CreateTool(name, diameter_m, config_folder, &tool);
    if (result != OSTEON_OK) return result;
    const OsteonPose X = PoseFromHost(axes_, pose);
    result = osteon_session_change_tool(session_, tool, &X);
    if (result == OSTEON_OK) std::swap(tool_, tool);
    osteon_tool_destroy(tool);
    return result;
  }

  /// Fills in the default parameters, as osteon_compliance_params_init, but with the mount's point and its
  /// values by axis along the host's axes. The point stays in metres.
  OsteonResult DefaultCompliance(OsteonComplianceParams* params) const {
    OsteonComplianceParams defaults;
    const OsteonResult result = osteon_compliance_params_init(OSTEON_ABI, &defaults);
    if (result == OSTEON_OK) *params = ComplianceToHost(axes_, defaults);
    return result;
  }

  /// Turns on the compliance of the chosen parts from the next Evaluate on. @param params  in the axes of
  /// DefaultCompliance
  OsteonResult SetCompliance(const OsteonComplianceParams& params) {
    const OsteonComplianceParams given = ComplianceFromHost(axes_, params);
    return osteon_session_set_compliance(OSTEON_ABI, session_, &given);
  }

  /// Displacements after the newest Evaluate.
  OsteonResult GetDeflection(Deflection* deflection) {
    OsteonDeflection found;
    const OsteonResult result = osteon_session_deflection(session_, &found);
    if (result == OSTEON_OK) *deflection = DeflectionToHost(axes_, found);
    return result;
  }

  /// Appends all bricks that changed since the last call.
  OsteonResult TakeChangedBricks(std::vector<Brick>* changed) {
    if (chunks_.empty()) {
      chunks_.resize(256);
      vertices_.resize(16 * OSTEON_CHUNK_MAX_VERTICES);
      indices_.resize(16 * OSTEON_CHUNK_MAX_INDICES);
    }
    OsteonSurfaceBuffers buffers{};
    buffers.chunks = chunks_.data();
    buffers.vertices = vertices_.data();
    buffers.indices = indices_.data();
    buffers.chunk_capacity = chunks_.size();
    buffers.vertex_capacity = vertices_.size();
    buffers.index_capacity = indices_.size();
    do {
      const OsteonResult result = osteon_session_surface_changes(session_, &generation_, &buffers);
      if (result != OSTEON_OK) return result;
      for (std::size_t i = 0; i < buffers.chunk_count; ++i) changed->push_back(BrickOf(chunks_[i]));
    } while (buffers.left > 0);
    return OSTEON_OK;
  }

 private:
  static OsteonResult CreateTool(const char* name, double diameter_m, const char* config_folder,
                                 OsteonTool** tool) {
    OsteonToolParams params;
    const OsteonResult result = osteon_tool_params_init(OSTEON_ABI, &params);
    if (result != OSTEON_OK) return result;
    params.name = name;
    params.diameter_m = diameter_m;
    params.config_folder = config_folder;
    return osteon_tool_create(OSTEON_ABI, &params, tool);
  }

  // Makes bone, tool and session. On failure Close() destroys those already made.
  OsteonResult Create(const SessionParams& params) {
    OsteonBoneParams bone;
    OsteonResult result = osteon_bone_params_init(OSTEON_ABI, &bone);
    if (result != OSTEON_OK) return result;
    bone.scene = params.scene;
    bone.config_folder = params.config_folder;
    result = osteon_bone_create(OSTEON_ABI, &bone, &bone_);
    if (result != OSTEON_OK) return result;
    result = CreateTool(params.tool, params.diameter_m, params.config_folder, &tool_);
    if (result != OSTEON_OK) return result;
    OsteonSettings settings;
    result = osteon_settings_init(OSTEON_ABI, &settings);
    if (result != OSTEON_OK) return result;
    settings.engine = static_cast<std::uint32_t>(params.engine);
    settings.lockstep = params.lockstep ? 1 : 0;
    settings.max_force_N = params.max_force_N;
    OsteonBoneInfo info;
    result = osteon_bone_info(bone_, &info);
    if (result != OSTEON_OK) return result;
    colors_.resize(info.material_count);
    for (std::uint32_t i = 0; i < info.material_count; ++i) {
      result = osteon_bone_material_color(bone_, i, colors_[i].data());
      if (result != OSTEON_OK) return result;
    }
    return osteon_session_create(OSTEON_ABI, bone_, tool_, &settings, &session_);
  }

  // Converts a chunk in vertices_ and indices_ to the host's axes, unit and order of corners.
  Brick BrickOf(const OsteonChunk& chunk) const {
    Brick brick;
    brick.number = chunk.brick;
    brick.positions.reserve(3 * std::size_t{chunk.vertex_count});
    brick.normals.reserve(3 * std::size_t{chunk.vertex_count});
    brick.colors.reserve(3 * std::size_t{chunk.vertex_count});
    for (std::uint32_t i = 0; i < chunk.vertex_count; ++i) {
      const OsteonVertex& v = vertices_[chunk.first_vertex + i];
      const Vector p =
          PositionToHost(axes_, {1e-3 * v.position_mm[0], 1e-3 * v.position_mm[1], 1e-3 * v.position_mm[2]});
      const Vector n = DirectionToHost(axes_, {v.normal[0], v.normal[1], v.normal[2]});
      for (std::size_t k = 0; k < 3; ++k) {
        brick.positions.push_back(static_cast<float>(p[k]));
        brick.normals.push_back(static_cast<float>(n[k]));
        const int color = v.material < colors_.size() ? colors_[v.material][k] : 255;
        brick.colors.push_back(static_cast<std::uint8_t>(v.cut != 0 ? color * 85 / 100 : color));
      }
    }
    const bool reversed = axes_.TurnsTrianglesOver();
    brick.indices.reserve(chunk.index_count);
    for (std::uint32_t i = 0; i + 2 < chunk.index_count; i += 3) {
      const std::uint16_t* corner = &indices_[chunk.first_index + i];
      brick.indices.push_back(corner[0]);
      brick.indices.push_back(corner[reversed ? 2 : 1]);
      brick.indices.push_back(corner[reversed ? 1 : 2]);
    }
    return brick;
  }

  Axes axes_;
  OsteonBone* bone_{nullptr};
  OsteonTool* tool_{nullptr};
  OsteonSession* session_{nullptr};
  std::uint64_t generation_{0};  // generation up to which chunks were copied (osteon_session_surface_changes)
  std::vector<std::array<std::uint8_t, 3>> colors_;  // red green blue of each material
  std::vector<OsteonChunk> chunks_;
  std::vector<OsteonVertex> vertices_;
  std::vector<std::uint16_t> indices_;
};

}  // namespace host
}  // namespace osteon
