#pragma once

#include "app/cli/usage/subcommand.h"
#include "studies/sharding/shard.h"

namespace osteon::app {

/// Adds --shard.
CLI::Option* AddShardOption(CLI::App& sub, studies::Sharding& sharding);
void TakeInvocation(const Invocation& invocation, studies::Sharding& sharding);

}  // namespace osteon::app
