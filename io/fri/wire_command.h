#pragma once

#include "base/marker.h"
#include "io/fri/messages.h"
#include "io/fri/proto_writer.h"
#include "io/fri/version.h"

// A client's answer in the wire's format (fri.proto). Private to the codec.

namespace osteon::io {

/// Writes an answer; omits poses if the family has none. out.ok() is false if the memory is too small.
/// @returns false if a value is not finite; the bytes written must then not be sent.
[[nodiscard]] bool WriteCommand(FriFamily family, const CommandMessage& message, ProtoWriter& out) OSTEON_RT;

}  // namespace osteon::io
