#pragma once

#include "safety/fault.h"

namespace osteon::app {

/// each(fault, text) for every fault that there is, in the order of their bits.
template <class Each>
void ForEachFault(Each&& each) {
  for (int bit = 0; bit < safety::kFaultCount; ++bit) {
    const auto fault = static_cast<safety::Fault>(1u << bit);
    each(fault, safety::Describe(fault));
  }
}

/// The same for those of a set.
template <class Each>
void ForEachFault(safety::FaultSet set, Each&& each) {
  ForEachFault([&](safety::Fault fault, const safety::FaultText& text) {
    if (set.Has(fault)) each(fault, text);
  });
}

}  // namespace osteon::app
