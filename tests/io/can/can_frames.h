#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "io/can/can_pump.h"

// Helpers for the CAN tests. Frames are written in candump's notation: "064#0B00" is a frame with the id
// 0x064 and two bytes.

namespace osteon::io {

/// The text of a frame in candump's notation.
inline std::string ToText(const CanFrame& frame) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string text;
  for (const int shift : {8, 4, 0}) text += kDigits[frame.id >> shift & 0xF];
  text += '#';
  for (std::size_t i = 0; i < std::min<std::size_t>(frame.size, frame.data.size()); ++i)
    text += {kDigits[frame.data[i] >> 4], kDigits[frame.data[i] & 0xF]};
  return text;
}

}  // namespace osteon::io

namespace osteon::io::test {

inline constexpr rt::Nanoseconds kMs = rt::kMillisecond;
inline constexpr rt::Nanoseconds kFrameTime = 130'000;  ///< duration of a frame of 8 bytes at 1 Mbit/s

/// The frame of a text in candump's notation.
inline CanFrame Frame(const std::string& text) {
  const std::size_t hash = text.find('#');
  CanFrame frame{.id = static_cast<std::uint16_t>(std::stoul(text.substr(0, hash), nullptr, 16))};
  for (std::size_t at = hash + 1; at + 1 < text.size(); at += 2)
    frame.data.at(frame.size++) = static_cast<std::uint8_t>(std::stoul(text.substr(at, 2), nullptr, 16));
  return frame;
}

/// A frame that arrives at this time. @param after_gap  true: the bus reports that frames before this one
/// were lost
inline CanArrival At(rt::Nanoseconds stamp, const std::string& text, bool after_gap = false) {
  return {.frame = Frame(text), .stamp = stamp, .after_gap = after_gap};
}

/// The frames that the client sends at the time `now`, at most 100.
inline std::vector<std::string> Sent(CanClient& client, rt::Nanoseconds now) {
  std::vector<std::string> frames;
  for (CanFrame frame; frames.size() < 100 && client.Next(now, frame);) frames.push_back(ToText(frame));
  return frames;
}

using Frames = std::vector<std::string>;

/// Makes a sensor's client. The test fails if the client refuses the parameters.
template <class Sensor, class Params>
[[nodiscard]] Sensor Made(const Params& params) {
  auto sensor = Sensor::Make(params);
  EXPECT_TRUE(sensor) << sensor.error();
  return *sensor;
}

}  // namespace osteon::io::test
