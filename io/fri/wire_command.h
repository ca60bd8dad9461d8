#pragma once

#include "control/rt/marker.h"
#include "io/fri/messages.h"
#include "io/fri/proto_writer.h"
#include "io/fri/version.h"

// A client's answer as it lies on the wire (fri.proto). Private to the codec.

namespace osteon::io {

/// Poses are left out where the family has none. Whether there was room, `out` says.
/// @returns false where a value is not finite: what was written is then not to be sent.
[[nodiscard]] bool WriteCommand(FriFamily family, const CommandMessage& message, ProtoWriter& out) OSTEON_RT;

}  // namespace osteon::io
