#pragma once

#include <array>
#include <cstdint>

#include "base/clock.h"
#include "base/marker.h"
#include "io/can/frame.h"

namespace osteon::io {

/// Two frames that a sensor sends back to back.
struct PairJoinerParams {
  std::uint16_t first_id{0}, second_id{0};
  std::uint8_t first_size{8}, second_size{8};
  /// The halves of a pair arrive within this time. Well below the time between pairs, so that a second half
  /// never joins the first half of another pair when the two frames between them are lost.
  rt::Nanoseconds window{rt::kMillisecond / 2};
};

/// Joins the two frames of a sensor's message, its halves, which carry no sequence number. A first half waits
/// for its second one. It is dropped when another first half comes, when the transport reports lost frames
/// (after_gap), or when the second half comes too late. A second half without a waiting first one is dropped.
class PairJoiner {
 public:
  enum class Result : std::uint8_t {
    kForeign,  ///< another id
    kWaiting,  ///< half a pair, or a half without its partner
    kJoined,   ///< bytes() is the pair, stamp() its arrival
  };

  explicit PairJoiner(const PairJoinerParams& params) : params_(params) {}

  /// Takes a frame of the bus. The bytes of a pair are complete if the result is kJoined.
  Result Add(const CanArrival& arrival) OSTEON_RT {
    const bool first = arrival.frame.id == params_.first_id, second = arrival.frame.id == params_.second_id;
    if (arrival.after_gap) GiveUp();
    if (!first && !second) return Result::kForeign;
    if (arrival.frame.size != (first ? params_.first_size : params_.second_size)) {
      ++malformed_;
      GiveUp();
      return Result::kWaiting;
    }
    if (first) {
      GiveUp();
      waiting_ = true;
      stamp_ = arrival.stamp;
      for (std::size_t i = 0; i < 8; ++i) bytes_[i] = arrival.frame.data[i];
      return Result::kWaiting;
    }
    // The stamps come from two clocks: a small negative difference does not mean another pair.
    const rt::Nanoseconds apart = arrival.stamp - stamp_;
    if (!waiting_ || apart > params_.window || apart < -params_.window) {
      GiveUp();
      ++halves_;
      return Result::kWaiting;
    }
    waiting_ = false;
    for (std::size_t i = 0; i < 8; ++i) bytes_[8 + i] = arrival.frame.data[i];
    return Result::kJoined;
  }

  /// Drops a first half that waits for its second one, and counts it in halves().
  void GiveUp() OSTEON_RT {
    halves_ += waiting_ ? 1 : 0;
    waiting_ = false;
  }

  [[nodiscard]] const std::array<std::uint8_t, 16>& bytes() const OSTEON_RT { return bytes_; }
  [[nodiscard]] rt::Nanoseconds stamp() const OSTEON_RT { return stamp_; }
  /// Number of halves that were dropped without their other half.
  [[nodiscard]] std::uint64_t halves() const OSTEON_RT { return halves_; }
  [[nodiscard]] std::uint64_t malformed() const OSTEON_RT { return malformed_; }  ///< frames of a wrong size

 private:
  PairJoinerParams params_;
  std::array<std::uint8_t, 16> bytes_{};
  rt::Nanoseconds stamp_{0};
  bool waiting_{false};
  std::uint64_t halves_{0}, malformed_{0};
};

}  // namespace osteon::io
