#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "io/can/can_pump.h"

namespace osteon::hil {

/// What becomes of frames on the way, as shares of 1; by default nothing.
struct VirtualCanParams {
  double loss{0.0};       ///< never arrives
  double duplicate{0.0};  ///< arrives twice
  double reorder{0.0};    ///< changes places with the next one of its step
  double corrupt{0.0};    ///< one byte or the size is another
  std::uint32_t seed{1};
  rt::Nanoseconds frame_time{130'000};  ///< of 8 bytes at 1 Mbit/s, with some stuffing
};

/// A CAN bus in virtual time: clients and simulated devices on one wire, frames handed over in memory. In
/// each step everybody hears what everybody else sends at `now`, one frame after the other; answers to what
/// was heard come in the same step while there are any. Two runs with the same calls are the same.
class VirtualCan {
 public:
  explicit VirtualCan(const VirtualCanParams& params = {}) : params_(params), random_(params.seed) {}

  /// The node must outlive the bus.
  void Add(io::CanClient& node) { nodes_.push_back({&node, true}); }

  /// Takes a node's plug out, or puts it in again.
  void Connect(const io::CanClient& node, bool connected);

  void SetParams(const VirtualCanParams& params) { params_ = params; }

  void Step(rt::Nanoseconds now);

  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// Of the last step: how long the wire was busy.
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
  [[nodiscard]] bool Happens(double share);
  void Damage(std::vector<OnTheWire>& wire);

  VirtualCanParams params_;
  std::mt19937 random_;
  std::vector<Node> nodes_;
  std::uint64_t frames_{0};
  rt::Nanoseconds busy_{0};
};

}  // namespace osteon::hil
