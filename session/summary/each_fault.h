#pragma once

#include "safety/fault.h"

namespace osteon::session {

/// Calls each(fault, text) for every fault, in the order of the bits.
template <class Each>
void ForEachFault(Each&& each) {
  for (int bit = 0; bit < safety::kFaultCount; ++bit) {
    const auto fault = static_cast<safety::Fault>(1u << bit);
    each(fault, safety::Describe(fault));
  }
}

/// Calls each(fault, text) for the faults of a set.
template <class Each>
void ForEachFault(safety::FaultSet set, Each&& each) {
  ForEachFault([&](safety::Fault fault, const safety::FaultText& text) {
    if (set.Has(fault)) each(fault, text);
  });
}

}  // namespace osteon::session
