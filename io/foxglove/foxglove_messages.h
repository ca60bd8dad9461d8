#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/clock.h"
#include "kinematics/spatial.h"

// Encodes a cell's 3D view in Foxglove's own schemas (foxglove.proto), which Foxglove and Lichtblick draw
// without any set-up.

namespace osteon::io {

/// A colour; each component is 0 … 1.
struct SceneColor {
  double r{0.0}, g{0.0}, b{0.0}, a{1.0};
};

// The parts of an entity, in its frame.
struct SceneBall {
  Vector3 center_m{Vector3::Zero()};
  double radius_m{0.0};
  SceneColor color;
};
struct SceneRod {
  Vector3 from_m{Vector3::Zero()}, to_m{Vector3::Zero()};
  double radius_m{0.0};
  SceneColor color;
};
struct SceneArrow {
  Vector3 from_m{Vector3::Zero()}, along_m{Vector3::Zero()};
  double diameter_m{0.0};
  SceneColor color;
};
struct SceneBox {
  Pose X_FB{Pose::Identity()};  ///< of the box's centre in the entity's frame
  Vector3 edges_m{Vector3::Zero()};
  SceneColor color;
};
struct SceneMesh {
  std::vector<Vector3> points_m{};
  std::vector<SceneColor> colors{};        ///< one for each point
  std::vector<std::uint32_t> triangles{};  ///< three points each
};

/// Parts that are replaced together: an entity replaces the earlier one with the same id.
struct SceneEntity {
  std::string id;
  std::string frame;  ///< the entity's parts move with this frame
  std::vector<SceneBall> balls{};
  std::vector<SceneRod> rods{};
  std::vector<SceneArrow> arrows{};
  std::vector<SceneBox> boxes{};
  SceneMesh mesh{};
};

/// A frame's pose in its parent frame.
struct FramePlace {
  std::string parent, child;
  Pose X_PC{Pose::Identity()};
};

/// Foxglove's numbers.
enum class LogLevel : std::uint8_t { kInfo = 2, kWarning = 3, kError = 4 };

/// Serialised google.protobuf.FileDescriptorSet that holds every foxglove schema here and what it imports.
[[nodiscard]] std::string FoxgloveDescriptorSet();

// Each overwrites `bytes` with the serialised message.

/// foxglove.FrameTransforms
void EncodeFrames(rt::Nanoseconds stamp, std::span<const FramePlace> frames, std::string& bytes);
/// foxglove.SceneUpdate. @param all  first remove every entity that the topic showed before
void EncodeScene(rt::Nanoseconds stamp, std::span<const SceneEntity> entities, bool all, std::string& bytes);
/// foxglove.JointStates; the joints are joint_1, … @param q_rad  positions
void EncodeJoints(rt::Nanoseconds stamp, std::span<const double> q_rad, std::string& bytes);
/// foxglove.Log of "osteon"
void EncodeLog(rt::Nanoseconds stamp, LogLevel level, const std::string& text, std::string& bytes);

}  // namespace osteon::io
