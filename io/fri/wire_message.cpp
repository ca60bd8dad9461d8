#include "io/fri/wire_message.h"

#include <algorithm>

#include "io/fri/proto_reader.h"

namespace osteon::io {
namespace {

// Read has one overload for each message type of fri.proto, which reads the type's fields by their numbers.
// Calls are nested as deep as the schema.
struct WireChecksum {};  // parts of a message that are checked but not used
struct WireEndOf {};
template <std::size_t N>
bool Read(ProtoReader in, WireArray<double, N>& wire) OSTEON_RT;
bool Read(ProtoReader in, WireHeader& wire) OSTEON_RT;
bool Read(ProtoReader in, WireTime& wire) OSTEON_RT;
bool Read(ProtoReader in, WireTransformation& wire) OSTEON_RT;
bool Read(ProtoReader in, WireRedundancy& wire) OSTEON_RT;
bool Read(ProtoReader in, WireIo& wire) OSTEON_RT;
bool Read(ProtoReader in, WireRobot& wire) OSTEON_RT;
bool Read(ProtoReader in, WireMonitor& wire) OSTEON_RT;
bool Read(ProtoReader in, WireConnection& wire) OSTEON_RT;
bool Read(ProtoReader in, WireIpo& wire) OSTEON_RT;
bool Read(ProtoReader in, WireChecksum& wire) OSTEON_RT;
bool Read(ProtoReader in, WireEndOf& wire) OSTEON_RT;

// Reads a nested message into `part`. If the message occurs again, it is merged with the earlier one.
template <class T>
void Merge(ProtoReader& in, T& part) OSTEON_RT {
  if (!Read(ProtoReader(in.Bytes()), part)) in.Fail();
}

template <class T>
void Merge(ProtoReader& in, std::optional<T>& part) OSTEON_RT {
  if (!part) part.emplace();
  Merge(in, *part);
}

// Reads a nested message of a repeated field, and adds it to the list.
template <class T, std::size_t N>
void Append(ProtoReader& in, FriList<T, N>& list) OSTEON_RT {
  T part;
  Merge(in, part);
  if (!list.Add(part)) in.Fail();
}

// Reads the messages JointValues and CartesianVector.
template <std::size_t N>
bool Read(ProtoReader in, WireArray<double, N>& wire) OSTEON_RT {
  while (in.Next()) {
    if (in.number() == 1)
      in.Append(wire.value, wire.count);
    else
      in.Skip();
  }
  return in.ok();
}

bool Read(ProtoReader in, WireHeader& wire) OSTEON_RT {
  while (in.Next()) switch (in.number()) {
      case 1:
        wire.id = in.Uint32();
        break;
      case 2:
        wire.sequence = in.Uint32();
        break;
      case 3:
        wire.reflected = in.Uint32();
        break;
      default:
        in.Skip();
    }
  return in.ok();
}

bool Read(ProtoReader in, WireTime& wire) OSTEON_RT {
  while (in.Next()) switch (in.number()) {
      case 1:
        wire.sec = in.Uint32();
        break;
      case 2:
        wire.nanosec = in.Uint32();
        break;
      default:
        in.Skip();
    }
  return in.ok();
}

bool Read(ProtoReader in, WireTransformation& wire) OSTEON_RT {
  while (in.Next()) switch (in.number()) {
      case 1:
        wire.name = in.Text(FriName::kMaxLength);
        break;
      case 2:
        in.Append(wire.element.value, wire.element.count);
        break;
      case 3:
        Merge(in, wire.time);
        break;
      default:
        in.Skip();
    }
  return in.ok();
}

bool Read(ProtoReader in, WireRedundancy& wire) OSTEON_RT {
  while (in.Next()) switch (in.number()) {
      case 1:
        wire.strategy = in.Uint32();
        break;
      case 2:
        wire.value = in.Double();
        break;
      default:
        in.Skip();
    }
  return in.ok();
}

bool Read(ProtoReader in, WireIo& wire) OSTEON_RT {
  while (in.Next()) switch (in.number()) {
      case 1:
        wire.name = in.Text(FriName::kMaxLength);
        break;
      case 2:
        wire.type = in.Enum();
        break;
      case 3:
        wire.direction = in.Enum();
        break;
      case 4:
        wire.digital = in.Uint64();
        break;
      case 5:
        wire.analog = in.Double();
        break;
      default:
        in.Skip();
    }
  return in.ok();
}

bool Read(ProtoReader in, WireRobot& wire) OSTEON_RT {
  while (in.Next()) switch (in.number()) {
      case 1:
        wire.joints = in.Int32();
        break;
      case 2:
        wire.safety = in.Enum();
        break;
      case 5:
        in.Append(wire.drives.value, wire.drives.count);
        break;
      case 6:
        wire.operation = in.Enum();
        break;
      case 7:
        wire.control = in.Enum();
        break;
      default:
        in.Skip();
    }
  return in.ok();
}

bool Read(ProtoReader in, WireMonitor& wire) OSTEON_RT {
  while (in.Next()) switch (in.number()) {
      case 1:
        Merge(in, wire.q_meas);
        break;
      case 2:
        Merge(in, wire.tau_meas);
        break;
      case 3:
        Merge(in, wire.q_cmd);
        break;
      case 4:
        Merge(in, wire.tau_cmd);
        break;
      case 5:
        Merge(in, wire.tau_ext);
        break;
      case 6:
        Merge(in, wire.force);
        break;
      case 8:
        Append(in, wire.ios);
        break;
      case 9:
        Merge(in, wire.pose);
        break;
      case 10:
        Merge(in, wire.redundancy);
        break;
      case 15:
        Merge(in, wire.time);
        break;
      default:
        in.Skip();
    }
  return in.ok();
}

bool Read(ProtoReader in, WireConnection& wire) OSTEON_RT {
  while (in.Next()) switch (in.number()) {
      case 1:
        wire.session = in.Enum();
        break;
      case 2:
        wire.quality = in.Enum();
        break;
      case 3:
        wire.period_ms = in.Uint32();
        break;
      case 4:
        wire.multiplier = in.Uint32();
        break;
      default:
        in.Skip();
    }
  return in.ok();
}

bool Read(ProtoReader in, WireIpo& wire) OSTEON_RT {
  while (in.Next()) switch (in.number()) {
      case 1:
        Merge(in, wire.q);
        break;
      case 2:
        Merge(in, wire.pose);
        break;
      case 3:
        Merge(in, wire.redundancy);
        break;
      case 10:
        wire.command_mode = in.Enum();
        break;
      case 11:
        wire.overlay = in.Enum();
        break;
      case 12:
        wire.tracking = in.Double();
        break;
      default:
        in.Skip();
    }
  return in.ok();
}

// The last part of a monitoring message (WireEndOf) is not used, but it is a known field, so it must be
// valid.

bool Read(ProtoReader in, WireChecksum& /*wire*/) OSTEON_RT {
  while (in.Next()) {
    if (in.number() == 1)
      (void)in.Int32();
    else
      in.Skip();
  }
  return in.ok();
}

bool Read(ProtoReader in, WireEndOf& /*wire*/) OSTEON_RT {
  WireChecksum checksum;
  while (in.Next()) switch (in.number()) {
      case 1:
        (void)in.Int32();
        break;
      case 2:
        Merge(in, checksum);
        break;
      default:
        in.Skip();
    }
  return in.ok();
}

bool Read(ProtoReader in, WireMonitoring& wire) OSTEON_RT {
  WireEndOf end;
  while (in.Next()) switch (in.number()) {
      case 1:
        Merge(in, wire.header);
        break;
      case 2:
        Merge(in, wire.robot);
        break;
      case 3:
        Merge(in, wire.monitor);
        break;
      case 4:
        Merge(in, wire.connection);
        break;
      case 5:
        Merge(in, wire.ipo);
        break;
      case 6:
        Append(in, wire.transformations);
        break;
      case 15:
        Merge(in, end);
        break;
      default:
        in.Skip();
    }
  return in.ok();
}

// Complete returns whether a message's required fields are present. It is called after all parts are read,
// because a message may occur in several parts.

bool Complete(const WireHeader& wire) OSTEON_RT { return wire.id && wire.sequence && wire.reflected; }
bool Complete(const WireTime& wire) OSTEON_RT { return wire.sec && wire.nanosec; }
bool Complete(const WireRedundancy& wire) OSTEON_RT { return wire.strategy && wire.value; }
bool Complete(const WireIo& wire) OSTEON_RT { return wire.name && wire.type && wire.direction; }
bool Complete(const WireConnection& wire) OSTEON_RT { return wire.session && wire.quality; }

bool Complete(const WireTransformation& wire) OSTEON_RT {
  return wire.name && (!wire.time || Complete(*wire.time));
}

template <class T>
bool Complete(const std::optional<T>& part) OSTEON_RT {
  return !part || Complete(*part);
}

template <class T, std::size_t N>
bool Complete(const FriList<T, N>& list) OSTEON_RT {
  return std::all_of(list.begin(), list.end(), [](const T& part) { return Complete(part); });
}

}  // namespace

bool ReadMonitoring(std::span<const std::uint8_t> body, WireMonitoring& wire) OSTEON_RT {
  if (!Read(ProtoReader(body), wire)) return false;
  const WireMonitor& monitor = wire.monitor;
  return Complete(wire.header) && Complete(monitor.ios) && Complete(monitor.pose) &&
         Complete(monitor.redundancy) && Complete(monitor.time) && Complete(wire.connection) &&
         Complete(wire.ipo.pose) && Complete(wire.ipo.redundancy) && Complete(wire.transformations);
}

}  // namespace osteon::io
