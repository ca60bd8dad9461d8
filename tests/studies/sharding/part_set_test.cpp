#include "studies/sharding/part_set.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "studies/sharding/exact_number.h"
#include "tests/io/temporary_folder.h"

namespace osteon::studies {
namespace {

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

TEST(PartSet, HasTheItemsOfAllPartsWhateverTheirOrder) {
  for (const std::size_t items : {0u, 1u, 5u, 12u}) {
    auto parts = PartsOf(4, items);
    std::swap(parts[0], parts[3]);
    const auto set = PartSet::From(parts);
    ASSERT_TRUE(set.has_value()) << set.error();
    EXPECT_EQ(set->items(), items);
    for (std::size_t i = 0; i < items; ++i) EXPECT_EQ(set->At(i)["item"], i);
  }
}

TEST(PartSet, NamesWhatDoesNotBelongToTheRun) {
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
  refused([](auto& parts) { parts[1].build = "other"; }, "part_2.json: found build other");
  refused([](auto& parts) { parts[1].words = {"tune"}; }, "part_2.json: found command tune");
  refused([](auto& parts) { parts[1].shard.of = 4; }, "part_2.json: found shard 2/4, accepted a shard of 3");
  refused([](auto& parts) { parts[1].items = 7; }, "part_2.json: found a count of items of 7, accepted 6");
  refused([](auto& parts) { parts.clear(); }, "found no part");
}

TEST(PartSet, APartReadsBackAsItWasWritten) {
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
  // a part of which an item was lost, or that has another's
  part.results.erase(1);
  io::test::WriteAll(part.file, PartText(part));
  EXPECT_FALSE(ReadPart(part.file).has_value());
  part.results[0] = nullptr;
  io::test::WriteAll(part.file, PartText(part));
  EXPECT_FALSE(ReadPart(part.file).has_value());
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
