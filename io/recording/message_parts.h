#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include <recording.pb.h>

#include "kinematics/spatial.h"

// Conversions between plain data and protobuf for parts that several messages share. Only for the sources of
// this folder that include libprotobuf.

namespace osteon::io {

// plain data to protobuf

inline void FillMessage(const PlainVector3& from, Vec3* to) {
  to->set_x(from.x);
  to->set_y(from.y);
  to->set_z(from.z);
}

inline void FillMessage(const PlainPose& from, Transform* to) {
  to->mutable_rotation()->Assign(from.R.begin(), from.R.end());
  FillMessage(from.p, to->mutable_position_m());
}

inline void FillMessage(const PlainWrench& from, ForceTorque* to) {
  FillMessage(from.f, to->mutable_force_n());
  FillMessage(from.t, to->mutable_torque_nm());
}

// protobuf to plain data; false if an array has the wrong length

inline void Get(const Vec3& from, PlainVector3& to) {
  to.x = from.x();
  to.y = from.y();
  to.z = from.z();
}

template <std::size_t N>
[[nodiscard]] bool Get(const google::protobuf::RepeatedField<double>& from, std::array<double, N>& to) {
  if (from.size() != static_cast<int>(N)) return false;
  std::copy(from.begin(), from.end(), to.begin());
  return true;
}

[[nodiscard]] inline bool Get(const Transform& from, PlainPose& to) {
  Get(from.position_m(), to.p);
  return Get(from.rotation(), to.R);
}

inline void Get(const ForceTorque& from, PlainWrench& to) {
  Get(from.force_n(), to.f);
  Get(from.torque_nm(), to.t);
}

// Parses the bytes as a Message. False if they are not a valid one.
template <class Message>
[[nodiscard]] bool Parse(std::span<const char> bytes, Message& message) {
  return bytes.size() <= static_cast<std::size_t>(std::numeric_limits<int>::max()) &&
         message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
}

}  // namespace osteon::io
