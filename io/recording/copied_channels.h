#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "io/recording/mcap_reader.h"
#include "io/recording/mcap_writer.h"

namespace osteon::io {

/// The channels of a file that is copied message by message. A damaged file may use one number for two
/// channels, one after the other.
class CopiedChannels {
 public:
  /// @param writer  outlives this
  explicit CopiedChannels(McapWriter& writer) : writer_(writer) {}

  /// The copy's number of a channel, which is added when it is first asked for. The error says how many
  /// channels there are.
  [[nodiscard]] tl::expected<std::uint16_t, std::string> IdOf(const McapChannel& channel) {
    constexpr std::size_t kMaxMeanings = 64, kMax = 60'000;
    std::vector<Known>& meanings = known_[channel.id];
    for (const Known& known : meanings)
      if (known.channel == channel) return known.id;
    if (meanings.size() == kMaxMeanings || count_ == kMax)
      return tl::unexpected("channel " + std::to_string(channel.id) + " is one of more than " +
                            (count_ == kMax ? std::to_string(kMax) + " in the file"
                                            : std::to_string(kMaxMeanings) + " of that number"));
    ++count_;
    meanings.push_back({channel, writer_.AddChannel(channel.topic, channel.schema_name, channel.schema,
                                                    channel.schema_encoding, channel.message_encoding)});
    return meanings.back().id;
  }

 private:
  struct Known {
    McapChannel channel;
    std::uint16_t id;
  };
  McapWriter& writer_;
  std::map<std::uint16_t, std::vector<Known>> known_;
  std::size_t count_{0};
};

}  // namespace osteon::io
