#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "io/can/can_pump.h"

namespace osteon::hil {

/// Probability of each fault of a frame on the bus, 0 … 1; all are 0 by default.
struct VirtualCanParams {
  double loss{0.0};       ///< the frame never arrives
  double duplicate{0.0};  ///< the frame arrives twice
  double reorder{0.0};    ///< the frame changes places with the next frame of its step
  double corrupt{0.0};    ///< one byte or the size of the frame changes
  std::uint32_t seed{1};
  rt::Nanoseconds frame_time{
      130'000};  ///< duration of a frame with 8 bytes at 1 Mbit/s, with some bit stuffing
};

/// A CAN bus in virtual time. Clients and simulated devices share one wire; their frames are passed in
/// memory. In each step, every node receives the frames that the others send at `now`, one after the other.
/// Replies follow in the same step until no node replies. Equal calls give equal results.
class VirtualCan {
 public:
  explicit VirtualCan(const VirtualCanParams& params = {}) : params_(params), random_(params.seed) {}

  /// Adds a node, which must outlive the bus.
  void Add(io::CanClient& node) { nodes_.push_back({&node, true}); }

  /// Disconnects a node, or connects it again.
  void Connect(const io::CanClient& node, bool connected);

  void SetParams(const VirtualCanParams& params) { params_ = params; }

  /// Passes all frames that the nodes send at `now`, and the replies to them.
  void Step(rt::Nanoseconds now);

  /// Number of frames that have arrived so far.
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// Time for which the wire was busy in the last step.
  [[nodiscard]] rt::Nanoseconds busy() const { return busy_; }

 private:
  struct Node {
    io::CanClient* client;
    bool connected;
  };
  struct OnTheWire {
    io::CanFrame frame;
    const io::CanClient* from;
  };
  /// Draws at random whether an event of this probability happens.
  [[nodiscard]] bool DrawEvent(double share);
  /// Applies loss, corruption, duplication and reordering to the frames of one round.
  void Damage(std::vector<OnTheWire>& wire);

  VirtualCanParams params_;
  std::mt19937 random_;
  std::vector<Node> nodes_;
  std::uint64_t frames_{0};
  rt::Nanoseconds busy_{0};
};

}  // namespace osteon::hil
