#include <random>

#include <gtest/gtest.h>

#include "simulation/packing/packing_file.h"
#include "tests/io/temporary_folder.h"
#include "tests/simulation/packing/packing_samples.h"

// Fixed-seed damage to a packing file. A damaged file must be refused, and the error must name byte and
// reason. If the checksums are recomputed after the damage, as an attacker would do, the file may be
// accepted, but then an engine must be able to use every value.

namespace osteon::simulation {
namespace {

using io::test::TemporaryFolder;
using io::test::WriteAll;
using namespace test;

constexpr unsigned kSeed = 20240917;

class PackingFuzz : public testing::Test {
 protected:
  void SetUp() override {
    const auto path = folder_.path() / "whole.osp";
    ASSERT_TRUE(WritePackingFile(path, SomeBone(30, 20), SomeProvenance()));
    whole_ = io::test::ReadAll(path);
  }

  /// The file with one to three changes: flipped bits, cuts, insertions, large numbers, or moved pieces.
  std::string Damaged() {
    std::string bytes = whole_;
    const int times = 1 + static_cast<int>(random_() % 3);
    for (int i = 0; i < times && !bytes.empty(); ++i) {
      // header and table are small, so half of the changes are made there
      const std::size_t at =
          random_() % (random_() % 2 == 0 ? std::min<std::size_t>(bytes.size(), 256) : bytes.size());
      switch (random_() % 6) {
        case 0:
          bytes[at] = static_cast<char>(bytes[at] ^ (1 << random_() % 8));
          break;
        case 1:
          bytes.resize(at);
          break;
        case 2:
          bytes.erase(at, 1 + random_() % 8);
          break;
        case 3:
          bytes.insert(at, 1 + random_() % 8, static_cast<char>(random_() % 256));
          break;
        case 4: {  // a number that careless code might use unchecked
          static constexpr std::uint64_t kNumbers[] = {0,          1,     0x7fffffff, 0xffffffff, 1ull << 32,
                                                       1ull << 60, ~0ull, ~0ull - 63, 0x7fc00000};
          const std::uint64_t number = kNumbers[random_() % std::size(kNumbers)];
          if (at + 8 <= bytes.size()) Put(bytes, at / 4 * 4 + 8 <= bytes.size() ? at / 4 * 4 : at, number);
          break;
        }
        default: {
          const std::size_t from = random_() % bytes.size(),
                            length = std::min<std::size_t>({32, bytes.size() - from, bytes.size() - at});
          bytes.replace(at, length, bytes.substr(from, length));
        }
      }
    }
    return bytes;
  }

  /// The file with one bit changed in the content of its sections, which follow the header and the table.
  std::string WithOneBitChanged() {
    std::string bytes = whole_;
    const std::size_t at = kTableAt + 6 * 32 + random_() % (bytes.size() - kTableAt - 6 * 32);
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << random_() % 8));
    return bytes;
  }

  TemporaryFolder folder_;
  std::string whole_;
  std::mt19937 random_{kSeed};
};

TEST_F(PackingFuzz, ADamagedFileIsAlwaysRefused) {
  SCOPED_TRACE(kSeed);
  const auto path = folder_.path() / "fuzz.osp";
  int damaged = 0;
  for (int i = 0; i < 700; ++i) {
    const std::string bytes = Damaged();
    if (bytes == whole_) continue;
    ++damaged;
    WriteAll(path, bytes);
    const auto file = PackingFile::Open(path, 1);
    ASSERT_FALSE(file) << "damage " << i;
    ASSERT_TRUE(file.error().byte || bytes.empty()) << file.error().Text();
    ASSERT_LE(file.error().byte.value_or(0), bytes.size()) << file.error().Text();
  }
  EXPECT_GT(damaged, 600);
}

TEST_F(PackingFuzz, AResealedFileIsRefusedOrUsable) {
  SCOPED_TRACE(kSeed);
  const auto path = folder_.path() / "fuzz.osp";
  int accepted = 0, refused = 0;
  for (int i = 0; i < 1000; ++i) {
    std::string bytes = i % 2 == 0 ? Damaged() : WithOneBitChanged();
    SealIfPossible(bytes);
    WriteAll(path, bytes);
    const auto file = PackingFile::Open(path, 1);
    if (!file) {
      ++refused;
      ASSERT_FALSE(file.error().found.empty());
      continue;
    }
    ++accepted;
    const Bone bone = file->ToBone();
    ASSERT_FALSE(bone.balls.empty());
    for (const Ball& ball : bone.balls) {
      ASSERT_TRUE(Vector3(ball.center_m).allFinite());
      ASSERT_TRUE(ball.radius_m > 0.0 && ball.radius_m <= 0.512);
    }
    for (const MassPoint& point : bone.points) {
      ASSERT_TRUE(Vector3(point.p_m).allFinite());
      ASSERT_TRUE(point.volume_m3 > 0.0 && std::isfinite(point.volume_m3));
      ASSERT_LT(point.material, bone.materials.size());
    }
    for (const Material& material : bone.materials)
      ASSERT_TRUE(material.density_kg_per_m3 > 0.0 && std::isfinite(material.density_kg_per_m3));
  }
  // the test is meaningful only if acceptance and refusal are both frequent
  EXPECT_GT(accepted, 200);
  EXPECT_GT(refused, 200);
}

}  // namespace
}  // namespace osteon::simulation
