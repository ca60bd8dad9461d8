#include "hil/injection/impaired_wire.h"

#include <algorithm>

#include "base/scramble.h"

namespace osteon::hil {
namespace {

using simulation::Scramble;
using simulation::Uniform;

// Derives a separate seed for each wire and direction.
std::uint64_t SeedOf(std::uint64_t seed, Wire wire, Direction direction) {
  return Scramble(Scramble(seed) + 4 * static_cast<std::uint64_t>(wire) +
                  static_cast<std::uint64_t>(direction));
}

}  // namespace

ImpairedWire::ImpairedWire(const InjectionParams& params, Wire wire, Direction direction,
                           const WireRoom& room)
    : schedule_(params, wire, direction),
      room_(room),
      seed_(SeedOf(params.seed, wire, direction)),
      slots_(room.datagrams),
      bytes_((room.datagrams + 2) * room.bytes) {}

std::uint64_t ImpairedWire::DrawBits(Draw draw) const OSTEON_RT {
  return Scramble(seed_ ^ Scramble(8 * counters_.pushed + static_cast<std::uint64_t>(draw)));
}

bool ImpairedWire::DrawEvent(Draw draw, double share) const OSTEON_RT {
  return Uniform(DrawBits(draw)) < share;
}

// Decides whether the present datagram is lost. Losses come in bursts of b datagrams. Outside a burst, a new
// burst begins with probability p, so (1 - p) / p datagrams pass between two bursts on average. p is chosen
// such that the share of lost datagrams, b / (b + (1 - p) / p), equals faults.loss.
bool ImpairedWire::IsLost(const WireFaults& faults) OSTEON_RT {
  if (faults.loss <= 0.0) {
    burst_left_ = 0;
    return false;
  }
  if (burst_left_ > 0) {
    --burst_left_;
    return true;
  }
  const double chance = faults.loss / (faults.loss + faults.burst * (1.0 - faults.loss));
  if (!DrawEvent(Draw::kLoss, chance)) return false;
  burst_left_ = faults.burst - 1;
  return true;
}

// Damages a datagram: one of four damaged datagrams is truncated, the others get bit errors in one byte.
// @returns the remaining size.
std::size_t ImpairedWire::Damage(std::span<std::uint8_t> datagram) OSTEON_RT {
  const std::size_t size = datagram.size(), kept = room_.intact;
  if (size <= kept) return size;  // no byte may be damaged
  ++counters_.corrupted;
  const std::uint64_t damage = DrawBits(Draw::kDamage), position = DrawBits(Draw::kPlace);
  if (damage % 4 == 0) return kept + position % (size - kept);
  datagram[kept + position % (size - kept)] ^= static_cast<std::uint8_t>(1 + (damage >> 8) % 255);
  return size;
}

void ImpairedWire::Push(std::span<const std::uint8_t> datagram, rt::Nanoseconds now) OSTEON_RT {
  ++counters_.pushed;
  if (datagram.size() > room_.bytes) {
    ++counters_.overflow;
    return;
  }
  const WireFaults faults = schedule_.At(now);
  if (faults.silence) {
    ++counters_.silenced;
    return;
  }
  if (IsLost(faults)) {
    ++counters_.lost;
    return;
  }

  const std::span<std::uint8_t> current{bytes_.data() + room_.datagrams * room_.bytes, room_.bytes};
  const std::span<std::uint8_t> held{current.data() + room_.bytes, room_.bytes};
  std::copy(datagram.begin(), datagram.end(), current.begin());
  std::size_t size = datagram.size();
  if (DrawEvent(Draw::kCorrupt, faults.corrupt)) size = Damage(current.first(size));
  int copies = 1;
  if (DrawEvent(Draw::kDuplicate, faults.duplicate)) {
    ++counters_.duplicated;
    ++copies;
  }
  const auto jitter = static_cast<double>(faults.jitter) * Uniform(DrawBits(Draw::kJitter));
  const rt::Nanoseconds due = now + faults.delay + static_cast<rt::Nanoseconds>(jitter);

  if (held_.copies == 0 && DrawEvent(Draw::kReorder, faults.reorder)) {
    std::copy_n(current.begin(), size, held.begin());
    held_ = {.copies = copies, .due = due, .size = size};
    return;
  }
  Enqueue(current.first(size), copies, due, now);
  if (held_.copies > 0) {
    ++counters_.reordered;
    Enqueue(held.first(held_.size), held_.copies, held_.due, now);
    held_ = {};
  }
}

void ImpairedWire::Enqueue(std::span<const std::uint8_t> datagram, int copies, rt::Nanoseconds due,
                           rt::Nanoseconds now) OSTEON_RT {
  last_due_ = std::max(last_due_, due);  // not due before the previous datagram
  for (int i = 0; i < copies; ++i) {
    if (count_ == slots_.size()) {
      ++counters_.overflow;
      continue;
    }
    const std::size_t slot = (first_ + count_++) % slots_.size();
    slots_[slot] = {.due = last_due_, .size = datagram.size()};
    std::copy(datagram.begin(), datagram.end(),
              bytes_.begin() + static_cast<std::ptrdiff_t>(slot * room_.bytes));
    if (last_due_ > now) ++counters_.delayed;
  }
}

std::span<const std::uint8_t> ImpairedWire::Next(rt::Nanoseconds now) OSTEON_RT {
  if (NextDue() > now) return {};
  const std::size_t slot = first_;
  first_ = (first_ + 1) % slots_.size();
  --count_;
  ++counters_.passed;
  return {bytes_.data() + slot * room_.bytes, slots_[slot].size};
}

}  // namespace osteon::hil
