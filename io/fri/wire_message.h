#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "base/marker.h"
#include "control/ports.h"
#include "io/fri/messages.h"

// A monitoring message in the wire's format (fri.proto): the received fields, as unchecked numbers. Private
// to the codec.

namespace osteon::io {

/// A repeated field. Only the first `count` values are set.
template <class T, std::size_t N>
struct WireArray {
  WireArray() OSTEON_RT {}  // user-provided, so that construction does not initialise the values
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
  std::optional<std::string_view> name;  // required; points into the datagram
  WireArray<double, 12> element;  // 12 elements of a 3x4 matrix (1.x), or 7 of position and quaternion (2.x)
  std::optional<WireTime> time;
};

struct WireRedundancy {
  std::optional<std::uint32_t> strategy;  // required
  std::optional<double> value;            // required
};

struct WireIo {
  std::optional<std::string_view> name;          // required; points into the datagram
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

/// The whole message.
struct WireMonitoring {
  WireHeader header;
  WireRobot robot;
  WireMonitor monitor;
  std::optional<WireConnection> connection;
  WireIpo ipo;
  FriList<WireTransformation, kFriMaxTransformations> transformations;
};

/// Reads a message by the rules of protobuf: unknown fields are skipped, the last of several values of a
/// field is used, and repeated occurrences of a nested message are merged. It is stricter than libprotobuf:
///
///   - a known field of another wire type is an error, not an unknown field; groups are errors; numbers are
///     bounded as in proto_reader.h
///   - integers and enums of 32 bits must fit 32 bits
///   - more repeated elements than there is room for, and names of more than 63 bytes, are errors, even if a
///     later value replaces them
///
/// @param[out] wire  must be default-constructed; its names point into `body`.
/// @returns false if the bytes are no such message, or a required field is missing.
[[nodiscard]] bool ReadMonitoring(std::span<const std::uint8_t> body, WireMonitoring& wire) OSTEON_RT;

}  // namespace osteon::io
