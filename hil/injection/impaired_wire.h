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

/// Counters of a wire's datagrams. At any time
///
///     pushed + duplicated = passed + lost + silenced + overflow + waiting
///
/// holds, with ImpairedWire::waiting(). Plain data.
struct WireCounters {
  std::uint64_t pushed{0};
  std::uint64_t passed{0};  ///< delivered by Next, copies included
  std::uint64_t lost{0};
  std::uint64_t duplicated{0};
  std::uint64_t reordered{0};  ///< delivered after the datagram that was pushed next
  std::uint64_t corrupted{0};
  std::uint64_t delayed{0};   ///< delivered later than they were pushed
  std::uint64_t silenced{0};  ///< not accepted during a silence
  /// Dropped because the wire was full or the datagram too long: the run needs a larger WireRoom.
  std::uint64_t overflow{0};

  friend bool operator==(const WireCounters&, const WireCounters&) = default;
};

/// Capacity of a wire.
struct WireRoom {
  std::size_t datagrams{1024};  ///< number of datagrams in transit; the default is one second at 1 kHz
  std::size_t bytes{1500};      ///< largest size of a datagram
  /// Number of leading bytes of each datagram that are never damaged, e.g. an identifier.
  std::size_t intact{0};
};

/// One direction of one wire, with a scenario's faults. Push accepts a datagram; Next returns it when it is
/// due.
///
/// Jitter does not change the datagrams' order, as on a line with a queue: a datagram is never due before its
/// predecessor. Only `reorder` changes the order, so reorderings are counted exactly: a reordered datagram
/// waits until the next datagram that is not lost has been enqueued.
///
/// The random draws for the n-th datagram depend only on seed, wire, direction and n. Other faults or other
/// times therefore do not change which datagrams are lost. One thread at a time; no allocation after
/// construction.
class ImpairedWire {
 public:
  static constexpr rt::Nanoseconds kNever = std::numeric_limits<rt::Nanoseconds>::max();

  /// @param direction  kToController or kFromController
  /// @throws std::invalid_argument from Validate(params).
  ImpairedWire(const InjectionParams& params, Wire wire, Direction direction, const WireRoom& room = {});

  /// Starts the schedule at `now`; call when COMMANDING_ACTIVE is first observed. Later calls change nothing.
  void StartSchedule(rt::Nanoseconds now) OSTEON_RT { schedule_.StartSchedule(now); }

  /// Sends a datagram at `now`. `now` must not decrease from call to call.
  void Push(std::span<const std::uint8_t> datagram, rt::Nanoseconds now) OSTEON_RT;

  /// Time at which the next datagram is due; kNever if none is in transit.
  [[nodiscard]] rt::Nanoseconds NextDue() const OSTEON_RT {
    return count_ == 0 ? kNever : slots_[first_].due;
  }

  /// Returns and removes the oldest datagram that is due at `now`; empty if there is none (check NextDue() if
  /// empty datagrams are possible). Valid until the next call.
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
  /// A reordered datagram, which waits until the next one has been enqueued.
  struct Held {
    int copies{0};
    rt::Nanoseconds due{0};
    std::size_t size{0};
  };
  enum class Draw : std::uint64_t { kLoss, kDuplicate, kReorder, kCorrupt, kDamage, kPlace, kJitter };

  // Random bits for one decision (`draw`) about the present datagram.
  [[nodiscard]] std::uint64_t DrawBits(Draw draw) const OSTEON_RT;
  [[nodiscard]] bool DrawEvent(Draw draw, double share) const OSTEON_RT;
  [[nodiscard]] bool IsLost(const WireFaults& faults) OSTEON_RT;
  [[nodiscard]] std::size_t Damage(std::span<std::uint8_t> datagram) OSTEON_RT;
  // Puts copies of a datagram in the ring. They are due at `due`, but not before the previous datagram.
  void Enqueue(std::span<const std::uint8_t> datagram, int copies, rt::Nanoseconds due,
               rt::Nanoseconds now) OSTEON_RT;

  FaultSchedule schedule_;
  WireRoom room_;
  std::uint64_t seed_;
  WireCounters counters_;
  std::vector<Slot> slots_;  // ring buffer of the datagrams in transit
  // data of all slots, then of the present datagram, then of the reordered one
  std::vector<std::uint8_t> bytes_;
  std::size_t first_{0}, count_{0};
  rt::Nanoseconds last_due_{std::numeric_limits<rt::Nanoseconds>::min()};
  Held held_;
  int burst_left_{0};
};

}  // namespace osteon::hil
