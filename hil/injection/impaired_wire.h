#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/clock.h"
#include "base/marker.h"
#include "hil/injection/fault_schedule.h"
#include "hil/injection/wire_faults.h"

namespace osteon::hil {

/// Counts the datagrams of a wire. At any time
///
///     pushed + duplicated = passed + lost + silenced + overflow + waiting
///
/// with `waiting` from ImpairedWire. Plain data.
struct WireCounters {
  std::uint64_t pushed{0};
  std::uint64_t passed{0};  ///< came out, copies included
  std::uint64_t lost{0};
  std::uint64_t duplicated{0};
  std::uint64_t reordered{0};  ///< came out after the datagram that was pushed next
  std::uint64_t corrupted{0};
  std::uint64_t delayed{0};   ///< delivered later than pushed
  std::uint64_t silenced{0};  ///< lost to a silence
  std::uint64_t overflow{0};  ///< found no room, or were too long: the run needs more than the wire holds

  friend bool operator==(const WireCounters&, const WireCounters&) = default;
};

/// Capacity of a wire.
struct WireRoom {
  std::size_t datagrams{1024};  ///< in transit at once: a second at 1 kHz
  std::size_t bytes{1500};      ///< of a datagram
  std::size_t intact{0};        ///< leading bytes of each that are never damaged, e.g. an identifier
};

/// One direction of one wire, with a scenario's faults. Datagrams go in by Push and come out by Next when
/// they are due.
///
/// Jitter does not change the order, as on a line with a queue: a datagram is never due before the one ahead
/// of it. Only `reorder` changes it, so reorderings are counted exactly: the datagram waits until the next
/// one that is not lost has passed.
///
/// The faults of the n-th datagram follow from seed, wire, direction and n alone: other faults, or other
/// times, do not change which datagrams are lost. One thread at a time; no allocation after construction.
class ImpairedWire {
 public:
  static constexpr rt::Nanoseconds kNever = std::numeric_limits<rt::Nanoseconds>::max();

  /// @param direction  kToController or kFromController
  /// @throws std::invalid_argument from Validate(params).
  ImpairedWire(const InjectionParams& params, Wire wire, Direction direction, const WireRoom& room = {});

  /// Starts the schedule at `now`, when COMMANDING_ACTIVE is seen; later calls change nothing.
  void StartSchedule(rt::Nanoseconds now) OSTEON_RT { schedule_.StartSchedule(now); }

  /// Sends a datagram at `now`, which does not decrease.
  void Push(std::span<const std::uint8_t> datagram, rt::Nanoseconds now) OSTEON_RT;

  /// When the next datagram comes out; kNever if none is in transit.
  [[nodiscard]] rt::Nanoseconds NextDue() const OSTEON_RT {
    return count_ == 0 ? kNever : slots_[first_].due;
  }

  /// The next datagram that is due at `now`, oldest first; empty if there is none (check NextDue() if empty
  /// datagrams are possible). Valid until the next call.
  [[nodiscard]] std::span<const std::uint8_t> Next(rt::Nanoseconds now) OSTEON_RT;

  [[nodiscard]] const WireCounters& counters() const OSTEON_RT { return counters_; }
  /// Number of datagrams in transit.
  [[nodiscard]] std::size_t waiting() const OSTEON_RT {
    return count_ + static_cast<std::size_t>(held_.copies);
  }
  /// Whether faults are configured for this wire.
  [[nodiscard]] bool injects() const { return !schedule_.empty(); }

 private:
  struct Slot {
    rt::Nanoseconds due{0};
    std::size_t size{0};
  };
  /// A datagram that is held until the next one has passed.
  struct Held {
    int copies{0};
    rt::Nanoseconds due{0};
    std::size_t size{0};
  };
  enum class Draw : std::uint64_t { kLoss, kDuplicate, kReorder, kCorrupt, kDamage, kPlace, kJitter };

  // Random bits for one draw about the present datagram.
  [[nodiscard]] std::uint64_t DrawBits(Draw draw) const OSTEON_RT;
  [[nodiscard]] bool DrawEvent(Draw draw, double share) const OSTEON_RT;
  [[nodiscard]] bool IsLost(const WireFaults& faults) OSTEON_RT;
  [[nodiscard]] std::size_t Damage(std::span<std::uint8_t> datagram) OSTEON_RT;
  // Puts copies in the ring, due not before the datagram ahead of them.
  void Enqueue(std::span<const std::uint8_t> datagram, int copies, rt::Nanoseconds due,
               rt::Nanoseconds now) OSTEON_RT;

  FaultSchedule schedule_;
  WireRoom room_;
  std::uint64_t seed_;
  WireCounters counters_;
  std::vector<Slot> slots_;          // a ring
  std::vector<std::uint8_t> bytes_;  // of the slots, then of the current datagram, then of the held one
  std::size_t first_{0}, count_{0};
  rt::Nanoseconds last_due_{std::numeric_limits<rt::Nanoseconds>::min()};
  Held held_;
  int burst_left_{0};
};

}  // namespace osteon::hil
