#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "control/ports.h"
#include "control/rt/marker.h"
#include "io/fri/messages.h"

// A monitoring message as it lies on the wire (fri.proto): which fields have come, as numbers, not yet
// checked for what they mean. Private to the codec.

namespace osteon::io {

/// A repeated field. Only the first `count` values are any.
template <class T, std::size_t N>
struct WireArray {
  WireArray() OSTEON_RT {}  // user-provided, so that making one leaves the values alone
  std::size_t count{0};
  std::array<T, N> value;
};
using WireJoints = WireArray<double, control::kJoints>;
using WireVector = WireArray<double, 6>;

struct WireHeader {
  std::optional<std::uint32_t> id, sequence, reflected;  // required
};

struct WireTime {
  std::optional<std::uint32_t> sec, nanosec;  // required
};

struct WireTransformation {
  std::optional<std::string_view> name;  // required; in the datagram
  WireArray<double, 12> element;
  std::optional<WireTime> time;
};

struct WireRedundancy {
  std::optional<std::uint32_t> strategy;  // required
  std::optional<double> value;            // required
};

struct WireIo {
  std::optional<std::string_view> name;          // required; in the datagram
  std::optional<std::uint32_t> type, direction;  // required
  std::optional<std::uint64_t> digital;
  std::optional<double> analog;
};

struct WireRobot {
  std::optional<std::int32_t> joints;
  std::optional<std::uint32_t> safety, operation, control;
  WireArray<std::uint32_t, control::kJoints> drives;
};

struct WireMonitor {
  std::optional<WireJoints> q_meas, tau_meas, q_cmd, tau_cmd, tau_ext;
  std::optional<WireVector> force;
  FriList<WireIo, kFriMaxIos> ios;
  std::optional<WireTransformation> pose;
  std::optional<WireRedundancy> redundancy;
  std::optional<WireTime> time;
};

struct WireConnection {
  std::optional<std::uint32_t> session, quality;  // required
  std::optional<std::uint32_t> period_ms, multiplier;
};

struct WireIpo {
  std::optional<WireJoints> q;
  std::optional<WireTransformation> pose;
  std::optional<WireRedundancy> redundancy;
  std::optional<std::uint32_t> command_mode, overlay;
  std::optional<double> tracking;
};

struct WireMonitoring {
  WireHeader header;
  WireRobot robot;
  WireMonitor monitor;
  std::optional<WireConnection> connection;
  WireIpo ipo;
  FriList<WireTransformation, kFriMaxTransformations> transformations;
};

/// Reads a protobuf as its specification says: unknown fields are passed over, of a field that comes again
/// the last value counts, a message that comes again adds to the one before. Stricter than libprotobuf:
///
///   - a known field of another wire type is wrong, not unknown; groups are wrong (proto_reader.h, with its
///     bounds of numbers)
///   - integers of 32 bits must be some, enums too
///   - more repeated elements than there is room for, and names of more than 63 bytes, are wrong, even if a
///     later value replaces them
///
/// @param[out] wire  to be as constructed; its names lie in `body`.
/// @returns false where it is not such a message, or a required field is missing.
[[nodiscard]] bool ReadMonitoring(std::span<const std::uint8_t> body, WireMonitoring& wire) OSTEON_RT;

}  // namespace osteon::io
