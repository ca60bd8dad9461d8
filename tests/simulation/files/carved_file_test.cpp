#include "simulation/files/carved_file.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "simulation/engine/reference_engine.h"
#include "tests/simulation/files/carved_samples.h"
#include "tests/simulation/packing/packing_samples.h"

// Tests of the file of a carved state. A run can resume from the file. Every damaged file is refused, with
// the number of the wrong byte.

namespace osteon::simulation {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHeader = 392;  // bytes before the payload

using test::CarvedBone, test::CarvedFrame, test::CarvedParams, test::CarvedTool;

/// A small bone that an engine has carved for six frames, and a temporary folder for its file.
class CarvedFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("osteon_carved_file_" + std::to_string(::getpid()) + "_" +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    path_ = folder_ / "state.osc";
    for (int i = 0; i < 6; ++i) engine_.Step(CarvedFrame(6e-3 - 0.2e-3 * i));
    state_ = engine_.Snapshot();
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string Bytes(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void WriteBytes(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }
  /// The file's bytes with a value at byte `at` replaced and the checksums recomputed, so that the check of
  /// the value itself is tested.
  template <typename Value>
  std::string Forged(std::string bytes, std::size_t at, const Value& value) const {
    std::memcpy(bytes.data() + at, &value, sizeof(value));
    const auto crc = [&](std::size_t from, std::size_t to) {
      return test::SlowCrc(bytes.substr(from, to - from));
    };
    const std::uint32_t payload = crc(kHeader, bytes.size());
    std::memcpy(bytes.data() + 384, &payload, 4);
    const std::uint32_t header = crc(0, 388);
    std::memcpy(bytes.data() + 388, &header, 4);
    return bytes;
  }
  /// The error of reading these bytes; empty: they were read.
  std::string ErrorOf(const std::string& bytes) const {
    WriteBytes(bytes);
    const auto read = ReadCarvedState(path_, bone_);
    return read ? "" : read.error().Text();
  }

  Bone bone_{CarvedBone()};
  ReferenceEngine engine_{bone_, CarvedTool(), Pose::Identity(), CarvedParams()};
  CarvedState state_;
  fs::path folder_, path_;
};

TEST_F(CarvedFile, ARunResumesFromTheFileBitForBit) {
  ASSERT_GT(state_.split_balls.size(), 1u);
  ASSERT_NE(std::count(state_.split_cuts.begin(), state_.split_cuts.end(), 0u), 0);
  ASSERT_TRUE(WriteCarvedState(path_, state_, bone_));
  const auto read = ReadCarvedState(path_, bone_);
  ASSERT_TRUE(read) << read.error().Text();
  EXPECT_EQ(HashState(*read), HashState(state_));
  EXPECT_EQ(read->frame, state_.frame);
  EXPECT_EQ(read->removed_mass_kg, state_.removed_mass_kg);
  EXPECT_EQ(std::memcmp(&read->X_GP, &state_.X_GP, sizeof(state_.X_GP)), 0);
  EXPECT_EQ(read->contact.pair_count, state_.contact.pair_count);
  ReferenceEngine other(CarvedBone(), CarvedTool(), Pose::Identity(), CarvedParams());
  other.Restore(*read);
  engine_.Restore(state_);
  for (int i = 6; i < 20; ++i) {
    const ContactModel a = engine_.Step(CarvedFrame(6e-3 - 0.2e-3 * i)),
                       b = other.Step(CarvedFrame(6e-3 - 0.2e-3 * i));
    ASSERT_EQ(std::memcmp(&a.X_WP, &b.X_WP, sizeof(a.X_WP)), 0) << i;
    ASSERT_EQ(a.removed_mass_kg, b.removed_mass_kg);
  }
  EXPECT_EQ(HashState(engine_.Snapshot()), HashState(other.Snapshot()));
  // equal states give equal files
  const std::string first = Bytes(path_);
  ASSERT_TRUE(WriteCarvedState(path_, *read, bone_));
  EXPECT_EQ(Bytes(path_), first);
}

TEST_F(CarvedFile, TruncationsAndFlippedBitsAreDetected) {
  ASSERT_TRUE(WriteCarvedState(path_, state_, bone_));
  const std::string good = Bytes(path_);
  ASSERT_LT(good.size(), 4000u);
  for (std::size_t size = 0; size < good.size(); size += size < kHeader ? 5 : 23)
    ASSERT_NE(ErrorOf(good.substr(0, size)), "") << size;
  for (std::size_t i = 0; i < good.size(); i += i < kHeader ? 1 : 5) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ (1 << (i % 8)));
    const std::string error = ErrorOf(bad);
    ASSERT_NE(error, "") << i;
    ASSERT_NE(error.find("accepted"), std::string::npos) << error;
  }
  EXPECT_NE(ErrorOf(good + "x"), "");
  EXPECT_EQ(ErrorOf(good), "");
}

TEST_F(CarvedFile, ErrorsNameTheByteTheValueFoundAndTheValuesAccepted) {
  ASSERT_TRUE(WriteCarvedState(path_, state_, bone_));
  const std::string good = Bytes(path_);
  const auto expect = [&](const std::string& bytes, const std::string& part) {
    const std::string error = ErrorOf(bytes);
    EXPECT_NE(error.find(part), std::string::npos) << error << "\nexpected: " << part;
  };
  expect("", "byte 0: header: found the end after 0 bytes, accepted 392 bytes and more");
  expect("BADMAGIC" + good.substr(8), "byte 0: magic");
  expect(Forged(good, 8, 2u), "byte 8: version: found 2, accepted 1");
  expect(Forged(good, 32, std::uint64_t{6}), "byte 32: balls of the bone: found 6, accepted 5");
  expect(Forged(good, 48, std::uint64_t{1} << 60), "byte 48: split balls");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const float nan_f = std::numeric_limits<float>::quiet_NaN();
  expect(Forged(good, 72, nan), "byte 72: proxy");
  expect(Forged(good, 168, -1.0), "byte 168: totals: found -1, accepted 0 and more");
  expect(Forged(good, 304 + 64, 9u), "byte 368: contact pairs: found 9, accepted 0 … 8");
  expect(Forged(good, 380, 7u), "byte 380: proxy's flag: found 7, accepted 0 or 1");
  expect(Forged(good, kHeader, nan_f), "ball 0: x: found nan mm");
  expect(Forged(good, kHeader + 16 * 2 + 12, -1.0f), "byte 436: ball 2: r: found -1 mm");
  expect(Forged(good, kHeader + 80 + 1, std::uint8_t{2}), "byte 473: mass point: found 2, accepted 0 or 1");
  expect(Forged(good, kHeader + 80 + 6, std::uint8_t{2}), "byte 478: padding");
  expect(Forged(good, kHeader + 88, 5u), "byte 480: split ball 0: found 5, accepted 0 … 4");
  const std::size_t cuts = kHeader + 88 + 4 * state_.split_balls.size();
  expect(Forged(good, cuts, 900u), "split ball 0: capsules: found 899");
  expect(Forged(good, cuts + 4 * state_.split_balls.size() + 4, nan_f), "slot 0: y: found nan mm");
}

TEST_F(CarvedFile, AFileOfAnotherBoneIsRefused) {
  ASSERT_TRUE(WriteCarvedState(path_, state_, bone_));
  Bone other = CarvedBone();
  other.balls[3].radius_m += 1e-9;
  const auto read = ReadCarvedState(path_, other);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().Text().find("bone's fingerprint"), std::string::npos) << read.error().Text();
  other = CarvedBone();
  other.points.pop_back();
  EXPECT_FALSE(ReadCarvedState(path_, other));
  EXPECT_FALSE(WriteCarvedState(path_, state_, other));
  EXPECT_FALSE(ReadCarvedState(folder_ / "none.osc", bone_));
}

TEST_F(CarvedFile, AFailedWriteKeepsTheOldFile) {
  ASSERT_TRUE(WriteCarvedState(path_, state_, bone_));
  const std::string good = Bytes(path_);
  CarvedState bad = state_;
  bad.split_slots.pop_back();
  const auto written = WriteCarvedState(path_, bad, bone_);
  ASSERT_FALSE(written);
  EXPECT_EQ(Bytes(path_), good);
  EXPECT_FALSE(WriteCarvedState(folder_ / "no" / "such.osc", state_, bone_));
  // no temporary file remains
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace osteon::simulation
