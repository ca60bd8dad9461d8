#include "console/server/foxglove_protocol.h"

#include <algorithm>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace osteon::console {
namespace {

using nlohmann::json;

constexpr std::size_t kShownWord = 30;  // number of characters of a wrong word that an error repeats
constexpr char kMessageData = 1;        // opcode of a topic's message

// The error for a message that is not accepted. @param found  what the message is instead
tl::unexpected<std::string> RefuseMessage(const std::string& found) {
  return tl::unexpected(fmt::format(
      "message: found {}, accepted {{\"op\": \"subscribe\", \"subscriptions\": [{{\"id\", \"channelId\"}}]}} "
      "and {{\"op\": \"unsubscribe\", \"subscriptionIds\": []}}: this server shows a cell, and takes nothing",
      found));
}

// Value of a member of a JSON object as an unsigned 32-bit number; nothing if there is no such number.
std::optional<std::uint32_t> NumberOf(const json& object, const char* name) {
  if (!object.is_object()) return std::nullopt;
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number_unsigned()) return std::nullopt;
  const auto value = found->get<std::uint64_t>();
  if (value > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(value);
}

// Encodes by RFC 4648, with padding.
std::string Base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t byte_count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t triple = 0;
    for (std::size_t k = 0; k < 3; ++k)
      triple = triple << 8 | (k < byte_count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= byte_count ? kDigits[triple >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

template <class Unsigned>
void AppendLittleEndian(Unsigned value, std::string& bytes) {
  for (std::size_t i = 0; i < sizeof value; ++i)
    bytes += static_cast<char>(static_cast<unsigned char>(value >> (8 * i) & 0xFFU));
}

// JSON as text. Bytes that are not UTF-8 become replacement characters.
std::string Dump(const json& message) { return message.dump(-1, ' ', false, json::error_handler_t::replace); }

}  // namespace

tl::expected<FoxgloveRequest, std::string> ParseFoxgloveRequest(std::string_view bytes,
                                                                std::size_t channels) {
  if (bytes.size() > kMaxFoxgloveMessage)
    return RefuseMessage(fmt::format("{} bytes (at most {})", bytes.size(), kMaxFoxgloveMessage));
  const json message = json::parse(bytes, nullptr, false);
  if (message.is_discarded()) return RefuseMessage("no JSON");
  if (!message.is_object() || !message.contains("op") || !message["op"].is_string())
    return RefuseMessage("another object");
  const auto& op = message["op"].get_ref<const std::string&>();
  const char* list_name = op == "subscribe" ? "subscriptions" : "subscriptionIds";
  if (op != "subscribe" && op != "unsubscribe") return RefuseMessage("\"" + op.substr(0, kShownWord) + "\"");
  if (!message.contains(list_name) || !message[list_name].is_array())
    return RefuseMessage(fmt::format("{} without {}", op, list_name));
  const json& list = message[list_name];
  if (list.size() > kMaxSubscriptions)
    return RefuseMessage(fmt::format("{} {} (at most {})", list.size(), list_name, kMaxSubscriptions));
  if (op == "subscribe") {
    FoxgloveSubscribe subscribe;
    for (const json& each : list) {
      const auto id = NumberOf(each, "id"), channel = NumberOf(each, "channelId");
      if (!id || !channel) return RefuseMessage("a subscription without a whole id and channelId");
      if (*channel >= channels)
        return RefuseMessage(fmt::format("channelId {} (below {})", *channel, channels));
      subscribe.subscriptions.push_back({.id = *id, .channel = *channel});
    }
    return subscribe;
  }
  FoxgloveUnsubscribe unsubscribe;
  for (const json& each : list) {
    const auto id = NumberOf(json{{"id", each}}, "id");
    if (!id) return RefuseMessage("a subscriptionId that is no whole number");
    unsubscribe.ids.push_back(*id);
  }
  return unsubscribe;
}

std::string FoxgloveServerInfo(const std::string& name, const std::string& session) {
  return Dump({{"op", "serverInfo"},
               {"name", name},
               {"capabilities", json::array()},
               {"metadata", json::object()},
               {"sessionId", session}});
}

std::string FoxgloveAdvertise(std::span<const FoxgloveChannel> channels) {
  json list = json::array();
  for (std::size_t i = 0; i < channels.size(); ++i)
    list.push_back({{"id", i},
                    {"topic", channels[i].topic},
                    {"encoding", "protobuf"},
                    {"schemaName", channels[i].schema_name},
                    {"schemaEncoding", "protobuf"},
                    {"schema", Base64(channels[i].schema)}});
  return Dump({{"op", "advertise"}, {"channels", list}});
}

std::string FoxgloveWarning(const std::string& text) {
  return Dump({{"op", "status"}, {"level", 1}, {"message", text}});
}

void FoxgloveMessageData(std::uint32_t subscription, rt::Nanoseconds stamp, std::string_view payload,
                         std::string& bytes) {
  bytes.clear();
  bytes += kMessageData;
  AppendLittleEndian(subscription, bytes);
  AppendLittleEndian(static_cast<std::uint64_t>(std::max<rt::Nanoseconds>(0, stamp)), bytes);
  bytes += payload;
}

}  // namespace osteon::console
