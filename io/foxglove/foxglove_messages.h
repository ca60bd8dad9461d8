#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/clock.h"
#include "kinematics/spatial.h"

// Encodes a cell's 3D view in Foxglove's schemas (foxglove.proto). Foxglove and Lichtblick can draw these
// without configuration.

namespace osteon::io {

/// A colour; each component is 0 … 1.
struct SceneColor {
  double r{0.0}, g{0.0}, b{0.0}, a{1.0};
};

// The following structs are parts of an entity; their positions are in the entity's frame.
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
  Pose X_FB{Pose::Identity()};  ///< pose of the box's centre in the entity's frame
  Vector3 edges_m{Vector3::Zero()};
  SceneColor color;
};
struct SceneMesh {
  std::vector<Vector3> points_m{};
  std::vector<SceneColor> colors{};        ///< one for each point
  std::vector<std::uint32_t> triangles{};  ///< indices of points, three for each triangle
};

/// A set of parts that is replaced as a whole: an entity replaces the earlier entity with the same id.
struct SceneEntity {
  std::string id;
  std::string frame;  ///< name of the frame to which the entity's parts are fixed
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

/// Levels of log messages, with Foxglove's numbers.
enum class LogLevel : std::uint8_t { kInfo = 2, kWarning = 3, kError = 4 };

/// Returns a serialised google.protobuf.FileDescriptorSet with every Foxglove schema used here and the
/// schemas that these import.
[[nodiscard]] std::string FoxgloveDescriptorSet();

// Each of the following functions overwrites `bytes` with the serialised message.

/// foxglove.FrameTransforms
void EncodeFrames(rt::Nanoseconds stamp, std::span<const FramePlace> frames, std::string& bytes);
/// foxglove.SceneUpdate. @param all  the message first removes all entities that the topic showed before
void EncodeScene(rt::Nanoseconds stamp, std::span<const SceneEntity> entities, bool all, std::string& bytes);
/// foxglove.JointStates; the joints are joint_1, … @param q_rad  positions
void EncodeJoints(rt::Nanoseconds stamp, std::span<const double> q_rad, std::string& bytes);
/// foxglove.Log with the name "osteon"
void EncodeLog(rt::Nanoseconds stamp, LogLevel level, const std::string& text, std::string& bytes);

}  // namespace osteon::io
