#pragma once

namespace osteon::kinematics {

/// Two doubles processed together in one vector register. Every x86-64 and AArch64 processor has such
/// registers.
using Pair [[gnu::vector_size(16)]] = double;

}  // namespace osteon::kinematics
