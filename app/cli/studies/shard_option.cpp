#include "app/cli/studies/shard_option.h"

namespace osteon::app {

CLI::Option* AddShardOption(CLI::App& sub, studies::Sharding& sharding) {
  const CLI::Validator valid(
      [](std::string& text) {
        const auto shard = studies::ParseShard(text);
        return shard ? std::string() : shard.error();
      },
      "");
  return sub
      .add_option_function<std::string>(
          "--shard", [&sharding](const std::string& text) { sharding.shard = *studies::ParseShard(text); },
          "compute part I of N alone, and write it to the file of --json; osteon merge puts all N together "
          "(docs/sharding.md)")
      ->check(valid)
      ->type_name("I/N");
}

void TakeInvocation(const Invocation& invocation, studies::Sharding& sharding) {
  sharding.words = invocation.words;
  sharding.parts = invocation.parts;
}

}  // namespace osteon::app
