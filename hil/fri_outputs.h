#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hil/fri_codec.h"

namespace osteon::hil {

/// The inputs, outputs and frames that the robot program registered, and what a client may do with them.
class FriOutputs {
 public:
  static constexpr std::size_t kMaxIos = 10, kMaxFrames = 5, kMaxName = 63;

  /// @throws std::invalid_argument on more entries than a message can carry, or a name that is empty, too
  ///   long or used twice.
  FriOutputs(std::vector<ArmIo> ios, std::vector<ArmFrame> frames);

  /// Applies a command's requests. @returns how many were refused: no such name, an input, or another type.
  std::uint64_t ApplyRequests(const FriCommand& command);

  /// An input of the robot changes. False where there is none of that name.
  bool SetInput(const ArmIo& input);

  [[nodiscard]] std::span<const ArmIo> ios() const { return ios_; }
  [[nodiscard]] std::span<const ArmFrame> frames() const { return frames_; }

 private:
  std::vector<ArmIo> ios_;
  std::vector<ArmFrame> frames_;
};

}  // namespace osteon::hil
