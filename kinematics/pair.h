#pragma once

namespace osteon::kinematics {

/// Two doubles processed together in one vector register, which every x86-64 and AArch64 has.
using Pair [[gnu::vector_size(16)]] = double;

}  // namespace osteon::kinematics
