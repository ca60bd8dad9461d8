#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <tl/expected.hpp>

#include "base/clock.h"

// Foxglove's live connection: https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md, as far as a
// source that only shows needs it. Text is JSON; a message of a topic is binary.

namespace osteon::console {

/// Names of the connection that viewers ask for; the messages used here are the same in both.
inline constexpr const char* kFoxgloveSubprotocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

/// A topic with the schema of its messages, which are protobuf.
struct FoxgloveChannel {
  std::string topic;        ///< "tf"
  std::string schema_name;  ///< "foxglove.FrameTransforms"
  std::string schema;       ///< a serialised FileDescriptorSet
};

inline constexpr std::size_t kMaxFoxgloveMessage = 8192;  ///< bytes of a viewer's message
inline constexpr std::size_t kMaxSubscriptions = 64;      ///< of one viewer

/// What a viewer asks for. Channels are counted as they were advertised, from 0.
struct FoxgloveSubscribe {
  struct One {
    std::uint32_t id{0};  ///< the viewer's own
    std::size_t channel{0};
  };
  std::vector<One> subscriptions;
};
struct FoxgloveUnsubscribe {
  std::vector<std::uint32_t> ids;
};
using FoxgloveRequest = std::variant<FoxgloveSubscribe, FoxgloveUnsubscribe>;

/// Reads a viewer's text message, which is hostile. The error names what was found and what is accepted.
/// @param channels  number of channels that are advertised
[[nodiscard]] tl::expected<FoxgloveRequest, std::string> ParseFoxgloveRequest(std::string_view bytes,
                                                                              std::size_t channels);

/// The first message to a viewer. @param session  differs from run to run
[[nodiscard]] std::string FoxgloveServerInfo(const std::string& name, const std::string& session);
[[nodiscard]] std::string FoxgloveAdvertise(std::span<const FoxgloveChannel> channels);
/// A line for a person: why a message was refused.
[[nodiscard]] std::string FoxgloveWarning(const std::string& text);
/// Overwrites `bytes` with a topic's message for a subscription.
void FoxgloveMessageData(std::uint32_t subscription, rt::Nanoseconds stamp, std::string_view payload,
                         std::string& bytes);

}  // namespace osteon::console
