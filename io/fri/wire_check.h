#pragma once

#include "io/fri/codec.h"
#include "io/fri/wire_message.h"
#include "io/fri/wire_units.h"

// Converts a message's fields from the format of the wire to that of messages.h, and checks the values.
// Private to the codec.

namespace osteon::io {

/// Reads and checks the fields of a message. Stores the first error.
class WireCheck {
 public:
  [[nodiscard]] CodecError error() const OSTEON_RT { return error_; }
  void Fail(CodecError error) OSTEON_RT {
    if (error_ == CodecError::kNone) error_ = error;
  }
  void CheckFinite(double value) OSTEON_RT;

  /// Reads an enum; a number above `largest` is an error. An absent field leaves `value` unchanged.
  template <class E>
  void ReadEnum(std::optional<std::uint32_t> wire, E largest, E& value) OSTEON_RT {
    if (!wire) return;
    if (*wire > static_cast<std::uint32_t>(largest)) return Fail(CodecError::kOutOfRange);
    value = static_cast<E>(*wire);
  }

  /// Reads joint values or a wrench. It is an error if only some of the values are present.
  template <std::size_t N>
  void ReadVector(const std::optional<WireArray<double, N>>& wire,
                  std::optional<std::array<double, N>>& value) OSTEON_RT {
    if (!wire) return;
    if (wire->count != N) return Fail(CodecError::kWrongCount);
    value = wire->value;
    if (!AllFinite(wire->value)) Fail(CodecError::kNotFinite);
  }

  void ReadPose(const std::optional<WireTransformation>& wire,
                const std::optional<WireRedundancy>& redundancy, std::optional<FriPose>& value) OSTEON_RT;
  /// Reads a 3x4 matrix (1.x) or a quaternion (2.x). Without elements the result is the identity: the frame
  /// is not set yet.
  void ReadTransformation(FriFamily family, const WireTransformation& wire,
                          FriTransformations& list) OSTEON_RT;
  void ReadIo(const WireIo& wire, FriIos& list) OSTEON_RT;

 private:
  CodecError error_{CodecError::kNone};
};

/// Reads a time; empty if the message has none.
[[nodiscard]] std::optional<FriTime> ReadTime(const std::optional<WireTime>& wire) OSTEON_RT;

}  // namespace osteon::io
