#pragma once

#include <fri.pb.h>

#include "io/fri/codec.h"

// The parts of a message, between nanopb's structs and ours: values are checked on the way in. Private to
// codec.cpp.

namespace osteon::io {

/// Collects what is wrong with a message: the first error found is the one reported.
class WireCheck {
 public:
  [[nodiscard]] CodecError error() const OSTEON_RT { return error_; }
  void Fail(CodecError error) OSTEON_RT {
    if (error_ == CodecError::kNone) error_ = error;
  }
  void Finite(double value) OSTEON_RT;

  template <class E>
  void Enum(bool has, std::uint32_t wire, E largest, E& value) OSTEON_RT {
    if (!has) return;
    if (wire > static_cast<std::uint32_t>(largest)) return Fail(CodecError::kOutOfRange);
    value = static_cast<E>(wire);
  }

  void Joints(bool has, const osteon_fri_JointValues& wire,
              std::optional<control::JointArray>& value) OSTEON_RT;
  void Wrench(bool has, const osteon_fri_CartesianVector& wire,
              std::optional<std::array<double, 6>>& value) OSTEON_RT;
  void Pose(bool has, const osteon_fri_Transformation& wire, bool has_redundancy,
            const osteon_fri_RedundancyInformation& redundancy, std::optional<FriPose>& value) OSTEON_RT;
  /// A 3x4 matrix in 1.x, a quaternion in 2.x; no elements at all are the identity: a frame not set yet.
  void Transformation(FriFamily family, const osteon_fri_Transformation& wire,
                      FriTransformations& list) OSTEON_RT;
  void Io(const osteon_fri_FriIOValue& wire, FriIos& list) OSTEON_RT;

 private:
  CodecError error_{CodecError::kNone};
};

// All of these: false where a value is not finite.

bool PutJoints(const std::optional<control::JointArray>& value, bool& has,
               osteon_fri_JointValues& wire) OSTEON_RT;
bool PutWrench(const std::optional<std::array<double, 6>>& value, bool& has,
               osteon_fri_CartesianVector& wire) OSTEON_RT;
bool PutPose(const FriPose& value, osteon_fri_Transformation& wire) OSTEON_RT;
bool PutTransformation(FriFamily family, const FriTransformation& value,
                       osteon_fri_Transformation& wire) OSTEON_RT;
bool PutIo(const FriIo& value, osteon_fri_FriIOValue& wire) OSTEON_RT;

}  // namespace osteon::io
