#include "studies/sharding/part_set.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "studies/sharding/exact_number.h"
#include "tests/io/temporary_folder.h"

namespace osteon::studies {
namespace {

// The part of a run of `items` results that a shard computes.
Part PartOf(const Shard& shard, std::size_t items) {
  Part part{.file = "part_" + std::to_string(shard.index) + ".json",
            .shard = shard,
            .items = items,
            .build = "a build",
            .checksum = "0123456789abcdef",
            .words = {"regress"}};
  for (std::size_t i = 0; i < items; ++i)
    if (shard.Has(i)) part.results[i] = {{"item", i}};
  return part;
}

// The parts of all shards of a run.
std::vector<Part> PartsOf(int of, std::size_t items) {
  std::vector<Part> parts;
  for (int index = 1; index <= of; ++index) parts.push_back(PartOf({.index = index, .of = of}, items));
  return parts;
}

TEST(PartSet, EveryItemIsInExactlyOneShard) {
  for (const int of : {1, 2, 3, 7, 64})
    for (std::size_t item = 0; item < 100; ++item) {
      int owners = 0;
      for (int index = 1; index <= of; ++index) owners += Shard{.index = index, .of = of}.Has(item) ? 1 : 0;
      EXPECT_EQ(owners, 1) << item << " of " << of;
    }
}

TEST(PartSet, JoinsTheItemsOfAllPartsInAnyOrder) {
  for (const std::size_t items : {0u, 1u, 5u, 12u}) {
    auto parts = PartsOf(4, items);
    std::swap(parts[0], parts[3]);
    const auto set = PartSet::From(parts);
    ASSERT_TRUE(set.has_value()) << set.error();
    EXPECT_EQ(set->items(), items);
    for (std::size_t i = 0; i < items; ++i) EXPECT_EQ(set->At(i)["item"], i);
  }
}

TEST(PartSet, RefusesPartsThatAreMissingOrOfAnotherRun) {
  const auto refused = [](const auto& change, const std::string& text) {
    auto parts = PartsOf(3, 6);
    change(parts);
    const auto set = PartSet::From(parts);
    ASSERT_FALSE(set.has_value()) << text;
    EXPECT_NE(set.error().find(text), std::string::npos) << set.error();
  };
  refused([](auto& parts) { parts.pop_back(); }, "missing: 3/3");
  refused([](auto& parts) { parts.push_back(parts[1]); },
          "part_2.json: found shard 2/3, which part_2.json is");
  refused([](auto& parts) { parts[2].checksum = "f"; }, "part_3.json: found options and inputs");
  refused(
      [](auto& parts) {
        parts[2].checksum = "f", parts[2].words = {"regress", "--exact"};
      },
      "part_3.json: found command regress --exact, accepted regress, as in part_1.json");
  refused([](auto& parts) { parts[1].build = "other"; }, "part_2.json: found build other");
  refused([](auto& parts) { parts[1].words = {"tune"}; }, "part_2.json: found command tune");
  refused([](auto& parts) { parts[1].shard.of = 4; }, "part_2.json: found shard 2/4, accepted a shard of 3");
  refused([](auto& parts) { parts[1].items = 7; }, "part_2.json: found a count of items of 7, accepted 6");
  refused([](auto& parts) { parts.clear(); }, "found no part");
}

TEST(PartSet, APartIsReadBackAsWritten) {
  const io::test::TemporaryFolder folder;
  Part part = PartOf({.index = 2, .of = 3}, 6);
  part.file = folder.path() / "part.json";
  part.results[4] = ExactNumber(0.1);
  io::test::WriteAll(part.file, PartText(part));
  const auto read = ReadPart(part.file);
  ASSERT_TRUE(read.has_value()) << read.error();
  EXPECT_EQ(read->shard, part.shard);
  EXPECT_EQ(read->items, part.items);
  EXPECT_EQ(read->words, part.words);
  EXPECT_EQ(read->results, part.results);
  // a part without one of its items, or with an item of another shard
  part.results.erase(1);
  io::test::WriteAll(part.file, PartText(part));
  EXPECT_FALSE(ReadPart(part.file).has_value());
  part.results[0] = nullptr;
  io::test::WriteAll(part.file, PartText(part));
  EXPECT_FALSE(ReadPart(part.file).has_value());
}

// A file that was changed after the shard wrote it is refused, with the key that is wrong.
TEST(PartSet, AChangedPartIsRefusedWithItsWrongKey) {
  const io::test::TemporaryFolder folder;
  Part part = PartOf({.index = 2, .of = 3}, 6);
  part.file = folder.path() / "part.json";
  const auto refused = [&](const auto& change, const std::string& text) {
    auto json = nlohmann::ordered_json::parse(PartText(part));
    change(json);
    io::test::WriteAll(part.file, json.dump());
    const auto read = ReadPart(part.file);
    ASSERT_FALSE(read.has_value()) << text;
    EXPECT_EQ(read.error().find(part.file.string()), 0u) << read.error();
    EXPECT_NE(read.error().find(text), std::string::npos) << read.error();
  };
  refused([](auto& json) { json["results"][0]["result"] = 2; }, "digest: found");
  refused([](auto& json) { json["build"] = "another"; }, "digest: found");
  refused([](auto& json) { json["command"][0] = "tune"; }, "digest: found");
  refused([](auto& json) { json["checksum"] = "f"; }, "digest: found");
  refused([](auto& json) { json.erase("digest"); }, "digest: found nothing, accepted a value");
  refused([](auto& json) { json["digest"] = 1; }, "digest: found 1, accepted a text");
  refused(
      [](auto& json) {
        json["command"] = {"regress", 1};
      },
      R"(command: found ["regress",1], accepted a list of texts)");
  refused([](auto& json) { json["shard"]["items"] = -6; },
          "items: found -6, accepted a whole number from 0 on");
  refused([](auto& json) { json["shard"]["items"] = 6.0; }, "items: found 6.0, accepted a whole number");
  refused([](auto& json) { json["results"][0]["item"] = true; }, "item: found true, accepted a whole number");
  refused([](auto& json) { json["shard"]["index"] = 4; }, "shard: found 4/3, accepted I/N");
}

TEST(PartSet, ValuesOfAnotherTypeAreRefused) {
  const nlohmann::json json{{"number", 0.5}, {"nan", "nan"},       {"text", "x"},    {"yes", true},
                            {"count", 3},    {"minus", -3},        {"list", {1, 2}}, {"null", nullptr},
                            {"many", 1e300}, {"mixed", {1, "two"}}};
  double number = 0.0;
  bool yes = false;
  std::uint32_t count = 0;
  std::string text;
  std::vector<double> list;
  ReadAt(json, "number", number), ReadAt(json, "yes", yes), ReadAt(json, "count", count);
  ReadAt(json, "text", text), ReadAt(json, "list", list);
  EXPECT_EQ(number, 0.5);
  EXPECT_TRUE(yes);
  EXPECT_EQ(count, 3u);
  EXPECT_EQ(text, "x");
  EXPECT_EQ(list, (std::vector<double>{1, 2}));
  ReadAt(json, "nan", number);
  EXPECT_TRUE(std::isnan(number));
  const auto refused = [&](const char* key, auto value, const std::string& accepted) {
    try {
      ReadAt(json, key, value);
      ADD_FAILURE() << key;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()).find(std::string(key) + ": found "), 0u) << error.what();
      EXPECT_NE(std::string(error.what()).find("accepted " + accepted), std::string::npos) << error.what();
    }
  };
  for (const char* key : {"text", "yes", "null", "list"}) refused(key, 0.0, "a number");
  for (const char* key : {"number", "yes", "minus", "many", "nan"})
    refused(key, count, "a whole number from 0 on");
  for (const char* key : {"count", "text", "null"}) refused(key, false, "true or false");
  for (const char* key : {"count", "null"}) refused(key, std::string(), "a text");
  for (const char* key : {"count", "mixed", "null"}) refused(key, std::vector<double>(), "a list of numbers");
  refused("list", std::vector<std::string>(), "a list of texts");
  refused("missing", 0.0, "a value");
}

TEST(PartSet, NumbersKeepEveryBit) {
  for (const double value : {0.1, -0.0, std::numbers::pi * 1e-300, std::numeric_limits<double>::denorm_min(),
                             std::numeric_limits<double>::max(), std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()}) {
    const double read = ExactNumberFrom(nlohmann::json::parse(ExactNumber(value).dump()));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(read), std::bit_cast<std::uint64_t>(value)) << value;
  }
  EXPECT_TRUE(std::isnan(ExactNumberFrom(ExactNumber(std::nan("")))));
  EXPECT_THROW(static_cast<void>(ExactNumberFrom("many")), std::invalid_argument);
}

TEST(PartSet, OptionsAreRemovedWithTheirValues) {
  EXPECT_EQ(WithoutOptions({"regress", "a", "--json", "x", "--exact", "--shard=1/2"}, {"--json", "--shard"}),
            (std::vector<std::string>{"regress", "a", "--exact"}));
}

}  // namespace
}  // namespace osteon::studies
