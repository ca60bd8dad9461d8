#pragma once

namespace osteon::kinematics {

/// Two doubles that go through an operation together: every x86-64 and AArch64 has such registers.
using Pair [[gnu::vector_size(16)]] = double;

}  // namespace osteon::kinematics
