#pragma once

#include <array>
#include <cstdint>

#include "base/clock.h"
#include "base/marker.h"
#include "io/can/frame.h"

namespace osteon::io {

/// Parameters of a message that a sensor sends as two consecutive frames.
struct PairJoinerParams {
  std::uint16_t first_id{0}, second_id{0};
  std::uint8_t first_size{8}, second_size{8};
  /// Longest time between the arrivals of a pair's two halves. It must be well below the time between pairs:
  /// if the two frames between a first half and the next pair's second half are lost, these two halves must
  /// not be joined.
  rt::Nanoseconds window{rt::kMillisecond / 2};
};

/// Joins the two frames (halves) of a sensor's message. The halves contain no sequence number. A first half
/// waits for its second half. It is dropped if another first half arrives, if the transport reports lost
/// frames (after_gap), or if the second half arrives too late. A second half is dropped if no first half
/// waits.
class PairJoiner {
 public:
  enum class Result : std::uint8_t {
    kForeign,  ///< the frame has another identifier
    kWaiting,  ///< no pair is complete yet: the half waits, or was dropped
    kJoined,   ///< bytes() is the pair, stamp() its arrival
  };

  explicit PairJoiner(const PairJoinerParams& params) : params_(params) {}

  /// Accepts a frame of the bus. If the result is kJoined, bytes() is a complete pair.
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
    // The stamps may come from two clocks, so a small negative difference is possible within a pair.
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
  /// Number of halves that were dropped because the other half was missing.
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
