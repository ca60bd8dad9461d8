#include "studies/sharding/part_set.h"

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/fnv1a.h"
#include "base/json_text.h"
#include "base/no_file_text.h"
#include "studies/sharding/exact_number.h"

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;

// The value of a part at a key, as text for the "found" of an error message.
std::string Found(const nlohmann::json& json, const char* key) {
  return json.contains(key) ? json[key].dump().substr(0, 60) : "nothing";
}

// Number of items that belong to a shard.
std::size_t CountOf(const Shard& shard, std::size_t items) {
  const auto before = static_cast<std::size_t>(shard.index - 1);
  return items <= before ? 0 : (items - before - 1) / static_cast<std::size_t>(shard.of) + 1;
}

// "2/4"
std::string Name(const Shard& shard) { return fmt::format("{}/{}", shard.index, shard.of); }

// Fills a part from its JSON; an error without the file's name.
tl::expected<Part, std::string> PartFrom(const nlohmann::json& json) {
  if (!json.is_object() || json.value("schema", nlohmann::json()) != kPartSchema)
    return tl::unexpected(fmt::format("found schema {}, accepted {}, which --shard writes",
                                      json.is_object() ? Found(json, "schema") : "nothing", kPartSchema));
  Part part;
  std::string digest;
  ReadAt(json, "build", part.build);
  ReadAt(json, "checksum", part.checksum);
  ReadAt(json, "command", part.words);
  ReadAt(json, "digest", digest);
  const nlohmann::json& shard = json.at("shard");
  const std::string name = fmt::format("{}/{}", shard.at("index").dump(), shard.at("of").dump());
  const auto parsed = ParseShard(name);
  if (!parsed) return tl::unexpected("shard: " + parsed.error());
  part.shard = *parsed;
  ReadAt(shard, "items", part.items);
  for (const nlohmann::json& result : json.at("results")) {
    std::size_t item = 0;
    ReadAt(result, "item", item);
    if (item >= part.items || !part.shard.Has(item))
      return tl::unexpected(
          fmt::format("found item {}, accepted those of shard {}, below {}", item, name, part.items));
    if (!part.results.emplace(item, result.at("result")).second)
      return tl::unexpected(fmt::format("found item {} twice, accepted once", item));
  }
  const std::size_t accepted = CountOf(part.shard, part.items);
  if (part.results.size() != accepted)
    return tl::unexpected(fmt::format("found {} items, accepted the {} of shard {}: run the shard again",
                                      part.results.size(), accepted, name));
  if (const std::string now = DigestOf(part); digest != now)
    return tl::unexpected(
        fmt::format("digest: found {}, accepted {}, that of what the part says: it was changed "
                    "after the shard had written it; run the shard again",
                    digest, now));
  return part;
}

// Says why a part does not belong to the same run as the first part; empty: it does.
std::string DifferenceFrom(const Part& first, const Part& part) {
  const auto differs = [&](const std::string& what, const std::string& found, const std::string& accepted) {
    return fmt::format("{}: found {} {}, accepted {}, as in {}: parts of one run", part.file.string(), what,
                       found, accepted, first.file.string());
  };
  if (part.words.empty() || first.words.empty() || part.words.front() != first.words.front())
    return differs("command", fmt::format("{}", fmt::join(part.words, " ")),
                   fmt::format("{}", fmt::join(first.words, " ")));
  if (part.checksum != first.checksum && part.words != first.words)
    return differs("command", fmt::format("{}", fmt::join(part.words, " ")),
                   fmt::format("{}", fmt::join(first.words, " ")));
  if (part.checksum != first.checksum)
    return differs("options and inputs with checksum", part.checksum, first.checksum);
  if (part.shard.of != first.shard.of)
    return differs("shard", Name(part.shard), fmt::format("a shard of {}", first.shard.of));
  if (part.build != first.build) return differs("build", part.build, first.build);
  if (part.items != first.items)
    return differs("a count of items of", std::to_string(part.items), std::to_string(first.items));
  return "";
}

}  // namespace

namespace {

// The JSON of a part without its digest. The digest is computed from this text.
nlohmann::ordered_json WithoutDigest(const Part& part) {
  nlohmann::ordered_json json{
      {"schema", kPartSchema},
      {"command", part.words},
      {"build", part.build},
      {"shard", {{"index", part.shard.index}, {"of", part.shard.of}, {"items", part.items}}},
      {"checksum", part.checksum},
      {"results", nlohmann::ordered_json::array()}};
  for (const auto& [item, result] : part.results)
    json["results"].push_back({{"item", item}, {"result", result}});
  return json;
}

}  // namespace

std::string DigestOf(const Part& part) {
  base::Fnv1a hash;
  hash.Add(base::JsonText(WithoutDigest(part)));
  return fmt::format("{:016x}", hash.hash());
}

std::string PartText(const Part& part) {
  nlohmann::ordered_json json = WithoutDigest(part);
  json["digest"] = DigestOf(part);
  return base::JsonText(json);
}

tl::expected<Part, std::string> ReadPart(const fs::path& file) {
  const auto failed = [&](const std::string& why) {
    return tl::unexpected(fmt::format("{}: {}", file.string(), why));
  };
  if (const std::string wrong = base::NoFileText(file); !wrong.empty()) return failed(wrong);
  std::ifstream stream(file);
  const nlohmann::json json = nlohmann::json::parse(stream, nullptr, false);
  if (json.is_discarded()) return failed("found no complete JSON, accepted a part: run the shard again");
  try {
    auto part = PartFrom(json);
    if (!part) return failed(part.error());
    part->file = file;
    return part;
  } catch (const nlohmann::json::exception& wrong) {
    return failed(fmt::format("found a damaged part ({}), accepted one as --shard writes it", wrong.what()));
  } catch (const std::invalid_argument& wrong) {  // a value of another type
    return failed(wrong.what());
  }
}

tl::expected<PartSet, std::string> PartSet::From(std::vector<Part> parts) {
  if (parts.empty()) return tl::unexpected(std::string("found no part, accepted all parts of one run"));
  PartSet set;
  std::map<int, fs::path> files;
  for (const Part& part : parts) {
    if (const std::string wrong = DifferenceFrom(parts.front(), part); !wrong.empty())
      return tl::unexpected(wrong);
    if (const auto [known, is_new] = files.emplace(part.shard.index, part.file); !is_new)
      return tl::unexpected(fmt::format("{}: found shard {}, which {} is too, accepted each shard once",
                                        part.file.string(), Name(part.shard), known->second.string()));
  }
  std::vector<std::string> missing;
  for (int index = 1; index <= parts.front().shard.of; ++index)
    if (!files.contains(index)) missing.push_back(Name({.index = index, .of = parts.front().shard.of}));
  if (!missing.empty())
    return tl::unexpected(fmt::format("{}: found {} of the {} shards of its run, accepted all; missing: {}",
                                      parts.front().file.string(), files.size(), parts.front().shard.of,
                                      fmt::join(missing, ", ")));
  for (const auto& [index, file] : files) set.files_.push_back(file);
  set.head_ = std::move(parts.front());
  for (auto part = parts.begin() + 1; part != parts.end(); ++part) set.head_.results.merge(part->results);
  return set;
}

tl::expected<PartSet, std::string> PartSet::Read(std::span<const fs::path> files) {
  std::vector<Part> parts;
  for (const fs::path& file : files) {
    auto part = ReadPart(file);
    if (!part) return tl::unexpected(part.error());
    parts.push_back(std::move(*part));
  }
  return From(std::move(parts));
}

}  // namespace osteon::studies
