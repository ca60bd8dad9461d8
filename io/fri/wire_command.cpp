#include "io/fri/wire_command.h"

#include "io/fri/codec.h"
#include "io/fri/wire_units.h"

namespace osteon::io {
namespace {

// Each of these functions writes a field with the given number. All except PutTime return false if a value is
// not finite.

bool PutJoints(std::uint32_t number, const control::JointArray& joints, ProtoWriter& out) OSTEON_RT {
  const std::size_t part = out.BeginMessage(number);
  out.Unpacked(1, joints);
  out.EndMessage(part);
  return AllFinite(joints);
}

bool PutVector(std::uint32_t number, const std::array<double, 6>& vector, ProtoWriter& out) OSTEON_RT {
  const std::size_t part = out.BeginMessage(number);
  out.Packed(1, vector);
  out.EndMessage(part);
  return AllFinite(vector);
}

void PutTime(std::uint32_t number, const std::optional<FriTime>& time, ProtoWriter& out) OSTEON_RT {
  if (!time) return;
  const std::size_t part = out.BeginMessage(number);
  out.Varint(1, time->sec);
  out.Varint(2, time->nanosec);
  out.EndMessage(part);
}

bool PutElements(std::uint32_t number, const FriName& name, std::span<const double> elements,
                 const std::optional<FriTime>& time, ProtoWriter& out) OSTEON_RT {
  const std::size_t part = out.BeginMessage(number);
  out.Text(1, name.view());
  out.Packed(2, elements);
  PutTime(3, time, out);
  out.EndMessage(part);
  return AllFinite(elements);
}

bool PutRedundancy(std::uint32_t number, const FriRedundancy& value, ProtoWriter& out) OSTEON_RT {
  const std::size_t part = out.BeginMessage(number);
  out.Varint(1, value.strategy);
  out.Double(2, value.value);
  out.EndMessage(part);
  return std::isfinite(value.value);
}

}  // namespace

bool WriteCommand(FriFamily family, const CommandMessage& message, ProtoWriter& out) OSTEON_RT {
  const std::size_t header = out.BeginMessage(1);
  out.Varint(1, kFriCommandId);
  out.Varint(2, message.sequence);
  out.Varint(3, message.reflected_sequence);
  out.EndMessage(header);

  const bool has_pose = message.X && family != FriFamily::k1;
  if (!message.q && !message.wire_wrench && !message.tau && !has_pose) return true;
  bool finite = true;
  const std::size_t data = out.BeginMessage(2);
  if (message.q) finite &= PutJoints(1, *message.q, out);
  if (message.wire_wrench) finite &= PutVector(2, *message.wire_wrench, out);
  if (message.tau) finite &= PutJoints(3, *message.tau, out);
  if (has_pose) {
    finite &= PutElements(6, message.X->name, message.X->element, message.X->time, out);
    if (message.X->redundancy) finite &= PutRedundancy(7, *message.X->redundancy, out);
  }
  out.EndMessage(data);
  return finite;
}

}  // namespace osteon::io
