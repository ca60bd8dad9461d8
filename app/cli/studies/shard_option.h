#pragma once

#include "app/cli/usage/subcommand.h"
#include "studies/sharding/shard.h"

namespace osteon::app {

/// Adds --shard, which sets sharding.shard.
CLI::Option* AddShardOption(CLI::App& sub, studies::Sharding& sharding);
/// Copies the words of the command line, and the parts that `osteon merge` has read, into a study's sharding.
void TakeInvocation(const Invocation& invocation, studies::Sharding& sharding);

}  // namespace osteon::app
