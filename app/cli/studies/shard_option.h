#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "studies/sharding/shard.h"

namespace osteon::app {

/// How a study that can be split was called.
struct Invocation {
  std::string command_line;                ///< the command that repeats the run
  std::vector<std::string> words;          ///< of the command line, after the program's name
  const studies::PartSet* parts{nullptr};  ///< the items of all shards, if `osteon merge` made the call
};

/// Adds --shard.
CLI::Option* AddShardOption(CLI::App& sub, studies::Sharding& sharding);
void TakeInvocation(const Invocation& invocation, studies::Sharding& sharding);

}  // namespace osteon::app
