#pragma once

#include "io/fri/codec.h"
#include "io/fri/wire_message.h"
#include "io/fri/wire_units.h"

// Converts the wire's numbers to ours and checks the values. Private to the codec.

namespace osteon::io {

/// Collects the errors of a message; the first one found is reported.
class WireCheck {
 public:
  [[nodiscard]] CodecError error() const OSTEON_RT { return error_; }
  void Fail(CodecError error) OSTEON_RT {
    if (error_ == CodecError::kNone) error_ = error;
  }
  void Finite(double value) OSTEON_RT;

  template <class E>
  void Enum(std::optional<std::uint32_t> wire, E largest, E& value) OSTEON_RT {
    if (!wire) return;
    if (*wire > static_cast<std::uint32_t>(largest)) return Fail(CodecError::kOutOfRange);
    value = static_cast<E>(*wire);
  }

  /// Joint values or a wrench: complete, or absent.
  template <std::size_t N>
  void Vector(const std::optional<WireArray<double, N>>& wire,
              std::optional<std::array<double, N>>& value) OSTEON_RT {
    if (!wire) return;
    if (wire->count != N) return Fail(CodecError::kWrongCount);
    value = wire->value;
    if (!AllFinite(wire->value)) Fail(CodecError::kNotFinite);
  }

  void Pose(const std::optional<WireTransformation>& wire, const std::optional<WireRedundancy>& redundancy,
            std::optional<FriPose>& value) OSTEON_RT;
  /// A 3x4 matrix in 1.x, a quaternion in 2.x; no elements mean the identity: a frame not set yet.
  void Transformation(FriFamily family, const WireTransformation& wire, FriTransformations& list) OSTEON_RT;
  void Io(const WireIo& wire, FriIos& list) OSTEON_RT;

 private:
  CodecError error_{CodecError::kNone};
};

[[nodiscard]] std::optional<FriTime> TimeOf(const std::optional<WireTime>& wire) OSTEON_RT;

}  // namespace osteon::io
