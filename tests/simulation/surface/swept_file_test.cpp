#include "simulation/surface/swept_file.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "simulation/surface/carved_field.h"
#include "tests/simulation/surface/surface_shapes.h"
#include "tests/temporary_path.h"

namespace osteon::surface {
namespace {

/// A ball of bone with a random cut, and with bricks that a capsule has removed entirely.
CarvedField CutBall() {
  CarvedField field(BallField(9.0F, 0.5F));
  std::mt19937 random(21);
  field.Carve(RandomToolPath(random, 8.0F, 3.0F, 60));
  const Capsule inside{{1.0F, 0.0F, 0.0F}, {-1.0F, 0.0F, 0.0F}, 8.0F};  // removes whole bricks
  field.Carve({&inside, 1});
  return field;
}

std::string BytesOf(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(SweptFile, ReadsBackTheWrittenField) {
  const CarvedField field = CutBall();
  const auto path = TemporaryPath("swept");
  ASSERT_TRUE(WriteSweptField(path, field.swept(), field.layout()));
  const auto read = ReadSweptField(path, field.layout());
  ASSERT_TRUE(read) << read.error().Text();
  int with_values = 0, full = 0;
  for (BrickIndex brick = 0; brick < field.layout().Count(); ++brick) {
    EXPECT_TRUE(field.swept().SameValues(*read, brick));
    with_values += field.swept().HasValues(brick) ? 1 : 0;
    full += field.swept().State(brick) == BrickField::kAllHigh ? 1 : 0;
  }
  EXPECT_GT(with_values, 10);
  EXPECT_GT(full, 0);
}

TEST(SweptFile, RefusesAnotherGrid) {
  const CarvedField field = CutBall();
  const auto path = TemporaryPath("swept");
  ASSERT_TRUE(WriteSweptField(path, field.swept(), field.layout()));
  const auto read = ReadSweptField(path, CarvedField(BallField(11.0F, 0.5F)).layout());
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().Text().find("byte 16: grid: found"), std::string::npos) << read.error().Text();
}

// A changed byte is detected wherever it is, and so is a missing rest of the file.
TEST(SweptFile, RefusesAFileWithAChangedOrMissingByte) {
  const CarvedField field = CutBall();
  const auto path = TemporaryPath("swept"), damaged = TemporaryPath("damaged");
  ASSERT_TRUE(WriteSweptField(path, field.swept(), field.layout()));
  const std::string bytes = BytesOf(path);
  std::mt19937 random(22);
  const auto refused = [&](const std::string& changed) {
    std::ofstream(damaged, std::ios::binary) << changed;
    return !ReadSweptField(damaged, field.layout());
  };
  for (int i = 0; i < 300; ++i) {
    std::string changed = bytes;
    const std::size_t at = i < 48 ? static_cast<std::size_t>(i) : random() % bytes.size();
    changed[at] = static_cast<char>(changed[at] ^ static_cast<char>(1U << random() % 8));
    EXPECT_TRUE(refused(changed)) << "byte " << at;
    EXPECT_TRUE(refused(bytes.substr(0, at))) << "ends at byte " << at;
  }
  EXPECT_TRUE(refused(bytes + "x"));
}

}  // namespace
}  // namespace osteon::surface
