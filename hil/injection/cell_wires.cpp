#include "hil/injection/cell_wires.h"

#include <array>
#include <cstring>
#include <type_traits>

#include "hil/fri_codec.h"
#include "simulation/packing/scramble.h"

namespace osteon::hil {
namespace {

using control::ForceReading;

static_assert(std::is_trivially_copyable_v<ForceReading> && sizeof(ForceReading) % 8 == 0);
constexpr std::size_t kWords = sizeof(ForceReading) / 8;
using Datagram = std::array<std::uint64_t, kWords + 1>;  // the reading, and its checksum

std::uint64_t Checksum(const Datagram& datagram) OSTEON_RT {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < kWords; ++i) sum = simulation::Scramble(sum ^ datagram[i]);
  return sum;
}

}  // namespace

CellWires::CellWires(const InjectionParams& params)
    : to_controller(params, Wire::kArm, Direction::kToController),
      from_controller(params, Wire::kArm, Direction::kFromController, {.bytes = kFriMaxDatagram + 1}),
      force_(params, Wire::kForceSensor, Direction::kToController, {.bytes = sizeof(Datagram)}) {}

void CellWires::Begin(rt::Nanoseconds now) OSTEON_RT {
  to_controller.Begin(now);
  from_controller.Begin(now);
  force_.Begin(now);
}

void CellWires::PushForce(const ForceReading& reading, rt::Nanoseconds now) OSTEON_RT {
  Datagram datagram{};
  std::memcpy(datagram.data(), &reading, sizeof reading);
  datagram[kWords] = Checksum(datagram);
  force_.Push({reinterpret_cast<const std::uint8_t*>(datagram.data()), sizeof datagram}, now);
}

bool CellWires::TakeForce(rt::Nanoseconds now, ForceReading& reading) OSTEON_RT {
  bool taken = false;
  while (force_.NextDue() <= now) {
    const auto bytes = force_.Next(now);
    Datagram datagram{};
    if (bytes.size() != sizeof datagram) continue;
    std::memcpy(datagram.data(), bytes.data(), sizeof datagram);
    if (datagram[kWords] != Checksum(datagram)) continue;
    ForceReading came;
    std::memcpy(static_cast<void*>(&came), datagram.data(), sizeof came);
    if (came.stamp < reading.stamp) continue;
    reading = came;
    taken = true;
  }
  return taken;
}

}  // namespace osteon::hil
