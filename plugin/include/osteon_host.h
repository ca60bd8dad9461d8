// osteon_host.h: what a game engine's plug-in in C++ needs beside osteon.h: its axes and units, a session in
// them, and the carved surface brick by brick. Header alone, C++17, no exception of its own; every failure is
// an OsteonResult, its text osteon_last_error().
//
//     p_host = units_per_m · P · p        places, velocities
//     d_host = P · d                      directions, forces (N)
//     a_host = det(P) · P · a             axial: torques (N·m), angular velocities, the vector part of quaternions
//
// P exchanges and mirrors axes: row i has `sign[i]` in column `from[i]`.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "osteon.h"

namespace osteon {
namespace host {

using Vector = std::array<double, 3>;

/// w x y z
using Quaternion = std::array<double, 4>;

struct Pose {
  Vector position{0.0, 0.0, 0.0};              ///< in the host's unit
  Quaternion orientation{1.0, 0.0, 0.0, 0.0};  ///< any length but 0
};

/// Axes and unit of a host.
struct Axes {
  std::array<std::size_t, 3> from;
  std::array<double, 3> sign;
  double units_per_m;
  /// Which way (b - a) × (c - a) of a triangle points, computed by components, that the host shows from
  /// outside: 1 outward, -1 inward. Osteon's point outward.
  int front;

  /// 1: right-handed as Osteon; -1: left-handed.
  constexpr int Determinant() const {
    const bool is_cyclic = (from[0] + 1) % 3 == from[1] && (from[1] + 1) % 3 == from[2];
    return (is_cyclic ? 1 : -1) * (sign[0] * sign[1] * sign[2] > 0.0 ? 1 : -1);
  }
  /// Whether a triangle's corners go the other way round.
  constexpr bool TurnsTrianglesOver() const { return Determinant() != front; }
};

inline constexpr Axes kOsteon{{0, 1, 2}, {1.0, 1.0, 1.0}, 1.0, 1};
/// Right-handed, +y up, metres; shows triangles that are clockwise.
inline constexpr Axes kGodot{{0, 2, 1}, {1.0, 1.0, -1.0}, 1.0, -1};
/// Left-handed, +y up, metres. Its plug-in is in C#; here for comparison.
inline constexpr Axes kUnity{{0, 2, 1}, {1.0, 1.0, 1.0}, 1.0, 1};
/// Left-handed, +z up, centimetres; shows triangles that are counter-clockwise.
inline constexpr Axes kUnreal{{0, 1, 2}, {1.0, -1.0, 1.0}, 100.0, -1};

inline Vector DirectionToHost(const Axes& axes, const Vector& v) {
  return {axes.sign[0] * v[axes.from[0]], axes.sign[1] * v[axes.from[1]], axes.sign[2] * v[axes.from[2]]};
}

inline Vector DirectionFromHost(const Axes& axes, const Vector& v) {
  Vector result{};
  for (std::size_t i = 0; i < 3; ++i) result[axes.from[i]] = axes.sign[i] * v[i];
  return result;
}

inline Vector Scaled(const Vector& v, double scale) { return {scale * v[0], scale * v[1], scale * v[2]}; }

inline Vector PositionToHost(const Axes& axes, const Vector& p_m) {
  return Scaled(DirectionToHost(axes, p_m), axes.units_per_m);
}

inline Vector PositionFromHost(const Axes& axes, const Vector& p) {
  return Scaled(DirectionFromHost(axes, p), 1.0 / axes.units_per_m);
}

/// Torques and angular velocities.
inline Vector AxialToHost(const Axes& axes, const Vector& v) {
  return Scaled(DirectionToHost(axes, v), axes.Determinant());
}

inline Vector AxialFromHost(const Axes& axes, const Vector& v) {
  return Scaled(DirectionFromHost(axes, v), axes.Determinant());
}

inline Quaternion RotationToHost(const Axes& axes, const Quaternion& q) {
  const Vector v = AxialToHost(axes, {q[1], q[2], q[3]});
  return {q[0], v[0], v[1], v[2]};
}

inline Quaternion RotationFromHost(const Axes& axes, const Quaternion& q) {
  const Vector v = AxialFromHost(axes, {q[1], q[2], q[3]});
  return {q[0], v[0], v[1], v[2]};
}

inline Pose PoseToHost(const Axes& axes, const OsteonPose& pose) {
  const double* p = pose.position_m;
  const double* q = pose.orientation_wxyz;
  return {PositionToHost(axes, {p[0], p[1], p[2]}), RotationToHost(axes, {q[0], q[1], q[2], q[3]})};
}

inline OsteonPose PoseFromHost(const Axes& axes, const Pose& pose) {
  const Vector p = PositionFromHost(axes, pose.position);
  const Quaternion q = RotationFromHost(axes, pose.orientation);
  return {{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}};
}

/// Rotation of a matrix by its rows, which may carry a positive scale; {0, 0, 0, 0}, which every function of
/// osteon.h refuses, where it cannot be a rotation.
inline Quaternion RotationOf(const std::array<Vector, 3>& rows) {
  std::array<Vector, 3> m = rows;
  for (std::size_t column = 0; column < 3; ++column) {
    const double length = std::hypot(rows[0][column], rows[1][column], rows[2][column]);
    if (!(length > 1e-9) || !std::isfinite(length)) return {0.0, 0.0, 0.0, 0.0};
    for (std::size_t row = 0; row < 3; ++row) m[row][column] /= length;
  }
  const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  if (!(determinant > 0.99)) return {0.0, 0.0, 0.0, 0.0};  // sheared, or mirrored
  // Shepperd's method: divides by the largest component
  const double trace = m[0][0] + m[1][1] + m[2][2];
  if (trace > 0.0) {
    const double s = 2.0 * std::sqrt(1.0 + trace);
    return {0.25 * s, (m[2][1] - m[1][2]) / s, (m[0][2] - m[2][0]) / s, (m[1][0] - m[0][1]) / s};
  }
  const std::size_t i = m[0][0] > m[1][1] ? (m[0][0] > m[2][2] ? 0 : 2) : (m[1][1] > m[2][2] ? 1 : 2);
  const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
  const double s = 2.0 * std::sqrt(1.0 + m[i][i] - m[j][j] - m[k][k]);
  Quaternion q{};
  q[0] = (m[k][j] - m[j][k]) / s;
  q[1 + i] = 0.25 * s;
  q[1 + j] = (m[j][i] + m[i][j]) / s;
  q[1 + k] = (m[k][i] + m[i][k]) / s;
  return q;
}

/// Rows of a rotation; q of length 1.
inline std::array<Vector, 3> RowsOf(const Quaternion& q) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  return {Vector{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
          Vector{2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
          Vector{2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}};
}

/// Force [N] and torque [N·m] on the tool at its apex, in the host's axes.
struct Wrench {
  Vector force_N{0.0, 0.0, 0.0};
  Vector torque_Nm{0.0, 0.0, 0.0};
};

/// A brick's mesh in the host's axes and unit; no vertex: the brick has gone.
struct Brick {
  std::uint32_t number{0};
  std::vector<float> positions, normals;  ///< x y z of each vertex
  std::vector<std::uint8_t> colors;   ///< red green blue of each vertex, sRGB; a cut face is 0.85 as bright
  std::vector<std::int32_t> indices;  ///< three of each triangle, as the host shows it from outside
};

struct SessionParams {
  const char* scene = nullptr;          ///< null: "acetabulum"
  const char* tool = nullptr;           ///< null: "reamer"
  double diameter_m = 0.0;              ///< 0: the tool's usual one
  const char* config_folder = nullptr;  ///< as OsteonBoneParams has it
  double max_force_N = 200.0;
  bool lockstep = false;
  OsteonEngine engine = OSTEON_ENGINE_AUTO;
};

/// A bone, a tool and their session, in the axes of a host. Threads as in osteon.h.
class Session {
 public:
  explicit Session(const Axes& axes) : axes_(axes) {}
  ~Session() { Close(); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Closes what was open first.
  OsteonResult Open(const SessionParams& params) {
    Close();
    const OsteonResult result = Create(params);
    if (result != OSTEON_OK) Close();  // keeps the text of the failure
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
  /// For all that is not below; null where none is open.
  OsteonSession* session() const { return session_; }
  /// The tool's usual spindle speed [rad/s].
  double spindle_rad_per_s() const { return osteon_tool_spindle_rad_per_s(tool_); }

  /// As osteon_bone_approach. @param height_m  in metres
  OsteonResult Approach(double height_m, Pose* pose) const {
    OsteonPose approach;
    const OsteonResult result = osteon_bone_approach(bone_, height_m, &approach);
    if (result == OSTEON_OK) *pose = PoseToHost(axes_, approach);
    return result;
  }

  /// Wait-free.
  OsteonResult SetToolPose(const Pose& pose, double spindle_rad_per_s) {
    const OsteonPose X = PoseFromHost(axes_, pose);
    return osteon_session_set_tool_pose(session_, &X, spindle_rad_per_s);
  }

  /// In lockstep.
  OsteonResult Step(const Pose& pose, double spindle_rad_per_s, double dt_s) {
    const OsteonPose X = PoseFromHost(axes_, pose);
    return osteon_session_step(session_, &X, spindle_rad_per_s, dt_s);
  }

  /// Wait-free; zero on failure.
  OsteonResult Evaluate(const Pose& pose, Wrench* wrench) {
    const OsteonPose X = PoseFromHost(axes_, pose);
    OsteonWrench F;
    const OsteonResult result = osteon_session_evaluate(session_, &X, nullptr, &F);
    wrench->force_N = DirectionToHost(axes_, {F.force_N[0], F.force_N[1], F.force_N[2]});
    wrench->torque_Nm = AxialToHost(axes_, {F.torque_Nm[0], F.torque_Nm[1], F.torque_Nm[2]});
    return result;
  }

  /// Collision-free pose of the tool in the newest frame.
  OsteonResult Proxy(Pose* pose) {
    OsteonFigures figures;
    const OsteonResult result = osteon_session_figures(session_, &figures);
    if (result == OSTEON_OK) *pose = PoseToHost(axes_, figures.proxy);
    return result;
  }

  OsteonResult Undo(const Pose& pose) {
    const OsteonPose X = PoseFromHost(axes_, pose);
    return osteon_session_undo(session_, &X);
  }

  /// Appends the bricks that changed since the last call, all of them.
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
  OsteonResult Create(const SessionParams& params) {
    OsteonBoneParams bone;
    osteon_bone_params_default(&bone);
    bone.scene = params.scene;
    bone.config_folder = params.config_folder;
    OsteonResult result = osteon_bone_create(OSTEON_ABI, &bone, &bone_);
    if (result != OSTEON_OK) return result;
    OsteonToolParams tool;
    osteon_tool_params_default(&tool);
    tool.name = params.tool;
    tool.diameter_m = params.diameter_m;
    tool.config_folder = params.config_folder;
    result = osteon_tool_create(OSTEON_ABI, &tool, &tool_);
    if (result != OSTEON_OK) return result;
    OsteonSettings settings;
    osteon_settings_default(&settings);
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
    const bool over = axes_.TurnsTrianglesOver();
    brick.indices.reserve(chunk.index_count);
    for (std::uint32_t i = 0; i + 2 < chunk.index_count; i += 3) {
      const std::uint16_t* corner = &indices_[chunk.first_index + i];
      brick.indices.push_back(corner[0]);
      brick.indices.push_back(corner[over ? 2 : 1]);
      brick.indices.push_back(corner[over ? 1 : 2]);
    }
    return brick;
  }

  Axes axes_;
  OsteonBone* bone_{nullptr};
  OsteonTool* tool_{nullptr};
  OsteonSession* session_{nullptr};
  std::uint64_t generation_{0};
  std::vector<std::array<std::uint8_t, 3>> colors_;  // by material
  std::vector<OsteonChunk> chunks_;
  std::vector<OsteonVertex> vertices_;
  std::vector<std::uint16_t> indices_;
};

}  // namespace host
}  // namespace osteon
