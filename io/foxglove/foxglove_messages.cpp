#include "io/foxglove/foxglove_messages.h"

#include <algorithm>

#include <foxglove.pb.h>
#include <google/protobuf/descriptor.pb.h>

#include "base/utf8.h"

namespace osteon::io {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
// Width and length of an arrow's head, as multiples of the shaft's diameter.
constexpr double kHeadWidth = 2.0, kHeadLength = 3.0;

// The functions Fill copy a value into a message of Foxglove's schemas.

void Fill(rt::Nanoseconds stamp, google::protobuf::Timestamp* to) {
  const std::int64_t time = std::max<std::int64_t>(0, stamp);  // MCAP has no negative times
  to->set_seconds(time / kSecond_ns);
  to->set_nanos(static_cast<std::int32_t>(time % kSecond_ns));
}

void Fill(const Vector3& from, foxglove::Vector3* to) {
  to->set_x(from.x());
  to->set_y(from.y());
  to->set_z(from.z());
}

void Fill(const Eigen::Quaterniond& from, foxglove::Quaternion* to) {
  to->set_x(from.x());
  to->set_y(from.y());
  to->set_z(from.z());
  to->set_w(from.w());
}

void Fill(const Pose& from, foxglove::Pose* to) {
  Fill(Vector3(from.translation()), to->mutable_position());
  Fill(Eigen::Quaterniond(Matrix3(from.linear())), to->mutable_orientation());
}

void Fill(const SceneColor& from, foxglove::Color* to) {
  to->set_r(from.r);
  to->set_g(from.g);
  to->set_b(from.b);
  to->set_a(from.a);
}

// Returns a pose at `place` whose z axis has the direction of `along`; without rotation if `along` is zero.
Pose ZAlong(const Vector3& place, const Vector3& along) {
  Pose X = Pose::Identity();
  X.translation() = place;
  if (along.norm() > 0.0) X.linear() = RotationFromZTo(along.normalized());
  return X;
}

// As ZAlong, but for the x axis.
Pose XAlong(const Vector3& place, const Vector3& along) {
  Matrix3 z_from_x;  // its columns are the images of the axes x, y and z: x becomes z
  z_from_x << 0, 0, -1, 0, 1, 0, 1, 0, 0;
  Pose X = ZAlong(place, along);
  if (along.norm() > 0.0) X.linear() = X.linear() * z_from_x;
  return X;
}

// The functions Add append a part to an entity.

void Add(const SceneBall& ball, foxglove::SceneEntity& to) {
  foxglove::SpherePrimitive* sphere = to.add_spheres();
  Pose X = Pose::Identity();
  X.translation() = ball.center_m;
  Fill(X, sphere->mutable_pose());
  Fill(Vector3(Vector3::Constant(2.0 * ball.radius_m)), sphere->mutable_size());
  Fill(ball.color, sphere->mutable_color());
}

void Add(const SceneRod& rod, foxglove::SceneEntity& to) {
  foxglove::CylinderPrimitive* cylinder = to.add_cylinders();
  const Vector3 along = rod.to_m - rod.from_m;
  Fill(ZAlong(0.5 * (rod.from_m + rod.to_m), along), cylinder->mutable_pose());
  Fill(Vector3(2.0 * rod.radius_m, 2.0 * rod.radius_m, along.norm()), cylinder->mutable_size());
  cylinder->set_bottom_scale(1.0);
  cylinder->set_top_scale(1.0);
  Fill(rod.color, cylinder->mutable_color());
}

void Add(const SceneArrow& arrow, foxglove::SceneEntity& to) {
  foxglove::ArrowPrimitive* added = to.add_arrows();
  const double length = arrow.along_m.norm(), head = std::min(length, kHeadLength * arrow.diameter_m);
  Fill(XAlong(arrow.from_m, arrow.along_m), added->mutable_pose());
  added->set_shaft_length(length - head);
  added->set_shaft_diameter(arrow.diameter_m);
  added->set_head_length(head);
  added->set_head_diameter(kHeadWidth * arrow.diameter_m);
  Fill(arrow.color, added->mutable_color());
}

void Add(const SceneBox& box, foxglove::SceneEntity& to) {
  foxglove::CubePrimitive* cube = to.add_cubes();
  Fill(box.X_FB, cube->mutable_pose());
  Fill(box.edges_m, cube->mutable_size());
  Fill(box.color, cube->mutable_color());
}

void Add(const SceneMesh& mesh, foxglove::SceneEntity& to) {
  if (mesh.triangles.empty()) return;
  foxglove::TriangleListPrimitive* list = to.add_triangles();
  Fill(Pose(Pose::Identity()), list->mutable_pose());
  for (const Vector3& p : mesh.points_m) {
    foxglove::Point3* point = list->add_points();
    point->set_x(p.x());
    point->set_y(p.y());
    point->set_z(p.z());
  }
  for (const SceneColor& color : mesh.colors) Fill(color, list->add_colors());
  list->mutable_indices()->Assign(mesh.triangles.begin(), mesh.triangles.end());
}

}  // namespace

std::string FoxgloveDescriptorSet() {
  google::protobuf::FileDescriptorSet set;
  const google::protobuf::FileDescriptor* file = foxglove::SceneUpdate::descriptor()->file();
  // dependencies first, because a FileDescriptorSet requires this order
  for (int i = 0; i < file->dependency_count(); ++i) file->dependency(i)->CopyTo(set.add_file());
  file->CopyTo(set.add_file());
  return set.SerializeAsString();
}

void EncodeFrames(rt::Nanoseconds stamp, std::span<const FramePlace> frames, std::string& bytes) {
  foxglove::FrameTransforms message;
  for (const FramePlace& frame : frames) {
    foxglove::FrameTransform* added = message.add_transforms();
    Fill(stamp, added->mutable_timestamp());
    added->set_parent_frame_id(base::Utf8(frame.parent));
    added->set_child_frame_id(base::Utf8(frame.child));
    Fill(Vector3(frame.X_PC.translation()), added->mutable_translation());
    Fill(Eigen::Quaterniond(Matrix3(frame.X_PC.linear())), added->mutable_rotation());
  }
  message.SerializeToString(&bytes);
}

void EncodeScene(rt::Nanoseconds stamp, std::span<const SceneEntity> entities, bool all, std::string& bytes) {
  foxglove::SceneUpdate message;
  if (all) {
    foxglove::SceneEntityDeletion* before = message.add_deletions();
    Fill(stamp, before->mutable_timestamp());
    before->set_type(foxglove::SceneEntityDeletion::ALL);
  }
  for (const SceneEntity& entity : entities) {
    foxglove::SceneEntity* added = message.add_entities();
    Fill(stamp, added->mutable_timestamp());
    added->set_frame_id(base::Utf8(entity.frame));
    added->set_id(base::Utf8(entity.id));
    added->set_frame_locked(true);
    for (const SceneBall& ball : entity.balls) Add(ball, *added);
    for (const SceneRod& rod : entity.rods) Add(rod, *added);
    for (const SceneArrow& arrow : entity.arrows) Add(arrow, *added);
    for (const SceneBox& box : entity.boxes) Add(box, *added);
    Add(entity.mesh, *added);
  }
  message.SerializeToString(&bytes);
}

void EncodeJoints(rt::Nanoseconds stamp, std::span<const double> q_rad, std::string& bytes) {
  foxglove::JointStates message;
  Fill(stamp, message.mutable_timestamp());
  for (std::size_t i = 0; i < q_rad.size(); ++i) {
    foxglove::JointState* joint = message.add_joints();
    joint->set_name("joint_" + std::to_string(i + 1));
    joint->set_position(q_rad[i]);
  }
  message.SerializeToString(&bytes);
}

void EncodeLog(rt::Nanoseconds stamp, LogLevel level, const std::string& text, std::string& bytes) {
  foxglove::Log message;
  Fill(stamp, message.mutable_timestamp());
  message.set_level(static_cast<foxglove::Log::Level>(level));
  message.set_message(base::Utf8(text));
  message.set_name("osteon");
  message.SerializeToString(&bytes);
}

}  // namespace osteon::io
