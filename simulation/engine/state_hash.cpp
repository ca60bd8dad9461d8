#include "simulation/engine/state_hash.h"

#include <fmt/format.h>

namespace osteon::simulation {

std::uint64_t HashState(const CarvedState& state) {
  // FNV-1a of 64 bits: the two constants are the offset basis and the prime
  std::uint64_t hash = 14695981039346656037ull;
  const auto mix = [&hash](const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 1099511628211ull;
  };
  mix(state.balls.data(), state.balls.size() * sizeof(float));
  mix(state.cleared.data(), state.cleared.size());
  mix(state.split_balls.data(), state.split_balls.size() * sizeof(std::uint32_t));
  mix(state.split_cuts.data(), state.split_cuts.size() * sizeof(std::uint32_t));
  mix(state.split_slots.data(), state.split_slots.size() * sizeof(float));
  return hash;
}

std::string HashText(const CarvedState& state) { return fmt::format("{:016x}", HashState(state)); }

}  // namespace osteon::simulation
