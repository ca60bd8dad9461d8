#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "io/recording/mcap_reader.h"
#include "io/recording/mcap_writer.h"

namespace osteon::io {

/// Maps the channel numbers of a source file to those of its copy, which is written message by message. A
/// damaged file may use one number for several channels, one after the other.
class CopiedChannels {
 public:
  /// @param writer  outlives this
  explicit CopiedChannels(McapWriter& writer) : writer_(writer) {}

  /// Returns the channel's number in the copy. The first call for a channel adds it to the copy. The error
  /// says that the file has too many channels, or that too many channels use one number.
  [[nodiscard]] tl::expected<std::uint16_t, std::string> IdOf(const McapChannel& channel) {
    constexpr std::size_t kMaxPerNumber = 64, kMaxChannels = 60'000;
    std::vector<Copied>& same_number = copied_[channel.id];
    for (const Copied& copied : same_number)
      if (copied.channel == channel) return copied.id;
    if (same_number.size() == kMaxPerNumber || count_ == kMaxChannels)
      return tl::unexpected("channel " + std::to_string(channel.id) + " is one of more than " +
                            (count_ == kMaxChannels ? std::to_string(kMaxChannels) + " in the file"
                                                    : std::to_string(kMaxPerNumber) + " of that number"));
    ++count_;
    same_number.push_back({channel, writer_.AddChannel(channel.topic, channel.schema_name, channel.schema,
                                                       channel.schema_encoding, channel.message_encoding)});
    return same_number.back().id;
  }

 private:
  struct Copied {
    McapChannel channel;
    std::uint16_t id;  // channel number in the copy
  };
  McapWriter& writer_;
  std::map<std::uint16_t, std::vector<Copied>> copied_;  // key: channel number in the source file
  std::size_t count_{0};                                 // number of channels in the copy
};

}  // namespace osteon::io
