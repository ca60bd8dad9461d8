#include "studies/sharding/study_items.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "base/fnv1a.h"
#include "base/write_text.h"
#include "session/setup/build_name.h"
#include "studies/sharding/part_set.h"

namespace osteon::studies {

StudyItems::StudyItems(const Sharding& sharding, std::string_view inputs) : sharding_(sharding) {
  base::Fnv1a hash;
  hash.Add(inputs);
  checksum_ = fmt::format("{:016x}", hash.hash());
}

std::string StudyItems::ValidateInputs() const {
  if (!FromParts()) return "";
  const PartSet& parts = *sharding_.parts;
  if (parts.checksum() != checksum_)
    return fmt::format("{}: found options and inputs with checksum {}, accepted {}: files have changed since",
                       parts.first_file().string(), parts.checksum(), checksum_);
  return "";
}

std::string StudyItems::Validate(std::size_t items) const {
  if (std::string wrong = ValidateInputs(); !wrong.empty() || !FromParts()) return wrong;
  const PartSet& parts = *sharding_.parts;
  if (parts.items() != items)
    return fmt::format("{}: found {} items, accepted {}: run the shards again", parts.first_file().string(),
                       parts.items(), items);
  return "";
}

const nlohmann::json& StudyItems::At(std::size_t item) const {
  // A study that reads its results from parts must have the same items as when the parts were made.
  if (item >= sharding_.parts->items())
    throw std::invalid_argument(fmt::format("{}: found {} items, accepted at least {}: run the shards again",
                                            sharding_.parts->first_file().string(), sharding_.parts->items(),
                                            item + 1));
  return sharding_.parts->At(item);
}

std::string StudyItems::WrongItem(std::size_t item, const char* wrong) const {
  return fmt::format("{}: item {}: {}", sharding_.parts->FileOf(item).string(), item, wrong);
}

void StudyItems::Store(std::size_t item, nlohmann::json result) {
  if (!sharding_.shard || !sharding_.shard->Has(item)) return;
  const std::scoped_lock lock(mutex_);
  stored_[item] = std::move(result);
}

tl::expected<void, std::string> StudyItems::WritePart(const std::filesystem::path& file, std::size_t items) {
  const std::scoped_lock lock(mutex_);
  const Part part{.file = file,
                  .shard = *sharding_.shard,
                  .items = items,
                  .build = session::BuildName(),
                  .checksum = checksum_,
                  .words = WithoutOptions(sharding_.words, {"--shard", "--json", "--out", "--config-root"}),
                  .results = stored_};
  const auto written = base::WriteText(file, PartText(part));
  if (!written) return written;
  fmt::print("shard {}/{}: {} of {} items in {}; osteon merge puts the parts together\n", part.shard.index,
             part.shard.of, part.results.size(), items, file.string());
  return {};
}

std::string ValidateSharding(const Sharding& sharding, const std::filesystem::path& json) {
  if (sharding.shard && json.empty())
    return "--shard: found without --json, accepted with it: the file of this part";
  return "";
}

}  // namespace osteon::studies
