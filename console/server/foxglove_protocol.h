#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <tl/expected.hpp>

#include "base/clock.h"

// The protocol of Foxglove's live connection
// (https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md), as far as a server that only publishes
// needs it. Text frames are JSON; a message of a topic is a binary frame.

namespace osteon::console {

/// WebSocket subprotocols that viewers request. The messages used here are the same in all of them.
inline constexpr const char* kFoxgloveSubprotocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

/// A topic with the schema of its messages, which are protobuf.
struct FoxgloveChannel {
  std::string topic;        ///< "tf"
  std::string schema_name;  ///< "foxglove.FrameTransforms"
  std::string schema;       ///< a serialised FileDescriptorSet
};

inline constexpr std::size_t kMaxFoxgloveMessage = 8192;  ///< bytes of a viewer's message
inline constexpr std::size_t kMaxSubscriptions = 64;      ///< number of subscriptions of one viewer

/// A viewer's request for topics.
struct FoxgloveSubscribe {
  struct One {
    std::uint32_t id{0};     ///< chosen by the viewer
    std::size_t channel{0};  ///< number in the order in which the channels were advertised, from 0
  };
  std::vector<One> subscriptions;
};
/// A viewer's request to end subscriptions, by the ids that it chose.
struct FoxgloveUnsubscribe {
  std::vector<std::uint32_t> ids;
};
using FoxgloveRequest = std::variant<FoxgloveSubscribe, FoxgloveUnsubscribe>;

/// Parses a viewer's text message, which may be hostile. The error names what was found and what is accepted.
/// @param channels  number of channels that are advertised
[[nodiscard]] tl::expected<FoxgloveRequest, std::string> ParseFoxgloveRequest(std::string_view bytes,
                                                                              std::size_t channels);

/// Makes the first message to a viewer. @param session  a text that differs from run to run
[[nodiscard]] std::string FoxgloveServerInfo(const std::string& name, const std::string& session);
/// Makes the message that lists the topics.
[[nodiscard]] std::string FoxgloveAdvertise(std::span<const FoxgloveChannel> channels);
/// Makes a message that tells a person why a viewer's message was refused.
[[nodiscard]] std::string FoxgloveWarning(const std::string& text);
/// Writes a topic's message for a subscription into `bytes`, replacing its old content.
void FoxgloveMessageData(std::uint32_t subscription, rt::Nanoseconds stamp, std::string_view payload,
                         std::string& bytes);

}  // namespace osteon::console
