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

  /// @throws std::invalid_argument on more than a message can carry, a name that is empty, too long or there
  /// twice.
  FriOutputs(std::vector<ArmIo> ios, std::vector<ArmFrame> frames);

  /// Takes what a command asks for. @returns how many of its requests were refused: of no registered name, to
  /// an input, of another type.
  std::uint64_t Take(const FriCommand& command);

  /// An input of the robot changes. False where there is none of that name.
  bool SetInput(const ArmIo& input);

  [[nodiscard]] std::span<const ArmIo> ios() const { return ios_; }
  [[nodiscard]] std::span<const ArmFrame> frames() const { return frames_; }

 private:
  std::vector<ArmIo> ios_;
  std::vector<ArmFrame> frames_;
};

}  // namespace osteon::hil
