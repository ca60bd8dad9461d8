#include "simulation/packing/packing_file.h"

#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <limits>

#include <gmock/gmock.h>

#include "tests/simulation/packing/packing_file_fixture.h"

// Tests of valid packing files: what is saved is loaded, loading and saving again gives the same bytes, and a
// failed save keeps the old file.

namespace osteon::simulation {
namespace {

using io::test::ReadAll;
using io::test::WriteAll;
using testing::HasSubstr;
using namespace test;

/// 2^-15 mm: coordinates in a file are multiples of it (docs/packing.md).
constexpr double kGrid_m = 1e-3 / 32768.0;

TEST_F(PackingFileTest, ALoadedBoneEqualsTheSavedBone) {
  const Bone bone = SomeBone();
  Saved(bone);
  const auto file = PackingFile::Open(Path());
  ASSERT_TRUE(file) << file.error().Text();
  const Bone loaded = file->ToBone();
  ASSERT_EQ(loaded.balls.size(), bone.balls.size());
  ASSERT_EQ(loaded.points.size(), bone.points.size());
  for (std::size_t i = 0; i < bone.points.size(); ++i) {
    // positions: half a grid step along each axis; volumes: rounding to float32
    EXPECT_LE((Vector3(loaded.points[i].p_m) - Vector3(bone.points[i].p_m)).cwiseAbs().maxCoeff(),
              0.501 * kGrid_m);
    EXPECT_NEAR(loaded.points[i].volume_m3 / bone.points[i].volume_m3, 1.0, 6e-8);
    EXPECT_EQ(loaded.points[i].material, bone.points[i].material);
  }
  ASSERT_EQ(loaded.materials.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(loaded.materials[i].name, bone.materials[i].name);
    EXPECT_EQ(loaded.materials[i].density_kg_per_m3, bone.materials[i].density_kg_per_m3);
    EXPECT_EQ(loaded.materials[i].specific_cutting_energy_J_per_m3,
              bone.materials[i].specific_cutting_energy_J_per_m3);
    EXPECT_EQ(loaded.materials[i].cutting_force_ratio, bone.materials[i].cutting_force_ratio);
    EXPECT_EQ(loaded.materials[i].friction, bone.materials[i].friction);
    EXPECT_EQ(loaded.materials[i].edge_force_N_per_m, bone.materials[i].edge_force_N_per_m);
    EXPECT_EQ(loaded.materials[i].measured_chip_m, bone.materials[i].measured_chip_m);
    for (const auto source :
         {&Material::density_source, &Material::cutting_energy_source, &Material::cutting_force_source,
          &Material::friction_source, &Material::edge_force_source}) {
      EXPECT_EQ((loaded.materials[i].*source).text, (bone.materials[i].*source).text);
      EXPECT_EQ((loaded.materials[i].*source).assumed, (bone.materials[i].*source).assumed);
    }
  }
  EXPECT_EQ(Vector3(loaded.site.center_m), Vector3(bone.site.center_m));
  EXPECT_EQ(Vector3(loaded.site.axis), Vector3(bone.site.axis));
  EXPECT_EQ(loaded.site.radius_m, bone.site.radius_m);
  EXPECT_EQ(loaded.name, bone.name);
  EXPECT_EQ(file->provenance(), SomeProvenance());
}

// The rounding of a saved ball may increase neither protrusion nor overlap.
TEST_F(PackingFileTest, EachSavedBallLiesWithinTheOriginalBall) {
  const Bone bone = SomeBone(5000, 0);
  Saved(bone);
  const auto file = PackingFile::Open(Path());
  ASSERT_TRUE(file) << file.error().Text();
  const Bone loaded = file->ToBone();
  ASSERT_EQ(loaded.balls.size(), bone.balls.size());
  for (std::size_t i = 0; i < bone.balls.size(); ++i) {
    const double moved_m = (Vector3(loaded.balls[i].center_m) - Vector3(bone.balls[i].center_m)).norm();
    // 1e-14 m: rounding of doubles near half a metre, and the writer's tolerance of 2e-4 grids
    EXPECT_LE(loaded.balls[i].radius_m + moved_m, bone.balls[i].radius_m + 1e-14);
    // the centre moves by half a diagonal of the grid at most, and the radius shrinks by that and a grid step
    EXPECT_LE(moved_m, 0.867 * kGrid_m);
    EXPECT_GE(loaded.balls[i].radius_m, bone.balls[i].radius_m - 1.867 * kGrid_m);
  }
}

TEST_F(PackingFileTest, ALoadedPackingIsSavedToTheSameBytes) {
  for (const double shift_m : {0.0, 0.4999999, 3.7, -9.87654321}) {
    Bone bone = SomeBone(3000, 1000);
    for (Ball& ball : bone.balls)
      ball.center_m = Vector3(ball.center_m) + Vector3(shift_m, -shift_m, 1.0 / 3.0);
    for (MassPoint& point : bone.points)
      point.p_m = Vector3(point.p_m) + Vector3(shift_m, -shift_m, 1.0 / 3.0);
    const std::string first = Saved(bone);
    const auto file = PackingFile::Open(Path());
    ASSERT_TRUE(file) << file.error().Text();
    const auto again = WritePackingFile(Path("again.osp"), file->ToBone(), file->provenance());
    ASSERT_TRUE(again) << again.error().Text();
    EXPECT_TRUE(ReadAll(Path("again.osp")) == first) << shift_m;
  }
}

TEST_F(PackingFileTest, MinusZeroIsSavedAsZero) {
  Bone bone = SomeBone(3, 2);
  // -1e-12 m rounds to minus zero on the grid, whose origin is zero here
  bone.balls = {{.center_m = Vector3(-1e-12, -0.0, 0.01), .radius_m = 1e-3},
                {.center_m = Vector3(0.0, 0.0, -0.01), .radius_m = 1e-3}};
  bone.points = {{.p_m = Vector3(-1e-13, 0.0, -0.0), .volume_m3 = 1e-9, .material = 0}};
  const std::string first = Saved(bone);
  const auto file = PackingFile::Open(Path());
  ASSERT_TRUE(file) << file.error().Text();
  ASSERT_TRUE(WritePackingFile(Path("again.osp"), file->ToBone(), file->provenance()));
  EXPECT_TRUE(ReadAll(Path("again.osp")) == first);
  EXPECT_FALSE(std::signbit(file->balls().front().x_mm));
}

// The middle of these balls is at half a millimetre, where rounding could go either way.
TEST_F(PackingFileTest, TheOriginOfASymmetricPackingIsTheSameWhenSavedAgain) {
  Bone bone = SomeBone(1, 0);
  for (const double width_mm : {1.0, 1.0 - 1e-6, 3.0, 20.0 + 1.0 / 3.0, 21.0 + 1e-5}) {
    bone.balls = {{.center_m = Vector3::Zero(), .radius_m = 1e-3},
                  {.center_m = Vector3::Constant(width_mm * 1e-3), .radius_m = 1e-3}};
    const std::string first = Saved(bone);
    const auto file = PackingFile::Open(Path());
    ASSERT_TRUE(file) << file.error().Text();
    ASSERT_TRUE(WritePackingFile(Path("again.osp"), file->ToBone(), file->provenance()));
    EXPECT_TRUE(ReadAll(Path("again.osp")) == first) << width_mm;
  }
}

TEST_F(PackingFileTest, TheBytesFollowTheDocumentedFormat) {
  const Bone bone = SomeBone();
  const std::string bytes = Saved(bone);
  EXPECT_EQ(bytes.substr(0, 8), "\x89OSP\r\n\x1a\n");
  EXPECT_EQ(bytes.substr(8, 8), std::string("\x04\x03\x02\x01\x01\x00\x00\x00", 8));
  EXPECT_EQ(Get<std::uint64_t>(bytes, kFileBytesAt), bytes.size());
  ASSERT_EQ(Get<std::uint32_t>(bytes, kSectionsAt), 6u);
  for (std::uint32_t i = 0; i < 6; ++i) {
    EXPECT_EQ(Get<std::uint32_t>(bytes, EntryAt(i)), i + 1);
    EXPECT_EQ(SectionAt(bytes, i) % 64, 0u);
  }
  const std::size_t ball = SectionAt(bytes, kBallSection) + 16 * 7;
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(Get<double>(bytes, kOriginAt + 8 * k) + Get<float>(bytes, ball + 4 * k),
                Vector3(bone.balls[7].center_m)[static_cast<Eigen::Index>(k)] * 1e3, 2e-5);
  EXPECT_NEAR(Get<float>(bytes, ball + 12), bone.balls[7].radius_m * 1e3, 6e-5);
  EXPECT_NE(bytes.find("material=enamel\ndensity_kg_per_m3="), std::string::npos);
  EXPECT_NE(bytes.find("bone=some bone\nprogram=osteon 0.1.0\nsource=some bone.obj\nsource_crc32=00beef42\n"),
            std::string::npos);
  // the test's own checksums equal the writer's
  std::string sealed = bytes;
  Seal(sealed);
  EXPECT_TRUE(sealed == bytes);
}

TEST_F(PackingFileTest, PointsAndSiteMayBeAbsent) {
  Bone bone = SomeBone(5, 0);
  bone.site.radius_m = 0.0;
  Saved(bone);
  const auto file = PackingFile::Open(Path());
  ASSERT_TRUE(file) << file.error().Text();
  EXPECT_FALSE(file->site());
  EXPECT_TRUE(file->points().empty());
  EXPECT_EQ(file->ToBone().site.radius_m, 0.0);
}

// Threads check pieces of a mebibyte each; this file has three whole pieces and a part of one.
TEST_F(PackingFileTest, TheFirstBadBallIsNamedForAnyNumberOfThreads) {
  std::string bytes = Saved(SomeBone(200'000, 0));
  for (const std::size_t i : {199'999u, 150'000u, 140'001u})
    Put(bytes, SectionAt(bytes, 0) + 16 * i + 12, std::nanf(""));
  Seal(bytes);
  WriteAll(Path("bad.osp"), bytes);
  for (const int threads : {1, 2, 8}) {
    const auto file = PackingFile::Open(Path("bad.osp"), threads);
    ASSERT_FALSE(file);
    EXPECT_THAT(file.error().Text(), HasSubstr("ball 140001: radius: found nan mm"));
  }
}

TEST_F(PackingFileTest, AnOpenFileIsUnchangedWhenItsPathIsReplaced) {
  Saved(SomeBone(10, 5));
  const auto file = PackingFile::Open(Path());
  ASSERT_TRUE(file);
  const float x = file->balls().front().x_mm;
  Saved(SomeBone(3, 1));
  EXPECT_EQ(file->balls().size(), 10u);
  EXPECT_EQ(file->balls().front().x_mm, x);
}

TEST_F(PackingFileTest, AnInvalidBoneIsRefusedAndLeavesNoFile) {
  const auto refused = [this](const std::function<void(Bone&)>& change) {
    Bone bone = SomeBone();
    change(bone);
    return WriteRefusal(bone).Text();
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refused([](Bone& b) { b.balls.clear(); }), HasSubstr("balls: found none, accepted 1 and more"));
  EXPECT_THAT(refused([](Bone& b) { b.balls[3].center_m.y = kNan; }), HasSubstr("ball 3: y: found nan mm"));
  EXPECT_THAT(refused([](Bone& b) { b.balls[3].radius_m = kNan; }),
              HasSubstr("ball 3: radius: found nan mm"));
  EXPECT_THAT(refused([](Bone& b) { b.balls[3].radius_m = -1e-3; }),
              HasSubstr("ball 3: radius: found -1 mm"));
  EXPECT_THAT(refused([](Bone& b) { b.balls[3].center_m.x += 1.1; }), HasSubstr("size along x: found 1"));
  EXPECT_THAT(refused([](Bone& b) { b.points[4].p_m.z = 1e9; }),
              HasSubstr("mass point 4: z: found 1000000000000 mm"));
  EXPECT_THAT(refused([](Bone& b) { b.points[4].volume_m3 = 0; }),
              HasSubstr("mass point 4: volume: found 0 mm^3"));
  EXPECT_THAT(refused([](Bone& b) { b.points[4].material = 3; }),
              HasSubstr("mass point 4: material: found 3"));
  EXPECT_THAT(refused([](Bone& b) {
                b.materials.clear();
                b.points.clear();
              }),
              HasSubstr("materials: found no material"));
  EXPECT_THAT(refused([](Bone& b) {
                while (b.materials.size() < 9) {
                  b.materials.push_back(b.materials.back());
                  b.materials.back().name += "*";
                }
              }),
              HasSubstr("materials: found a material more, accepted 1 … 8"));
  EXPECT_THAT(refused([](Bone& b) { b.materials[1].friction = kNan; }), HasSubstr("friction: found \"nan\""));
  EXPECT_THAT(refused([](Bone& b) { b.materials[1].density_source.text = "\xff"; }),
              HasSubstr("found \"\\xff\", accepted UTF-8"));
  EXPECT_THAT(refused([](Bone& b) { b.site.radius_m = -1; }), HasSubstr("site: radius: found -1 m"));
  EXPECT_THAT(refused([](Bone& b) { b.site.axis = Vector3(0, 0, 2); }),
              HasSubstr("site: axis: found (0, 0, 2)"));
  PackingProvenance twice = SomeProvenance();
  twice.parameters.emplace_back("seed", "8");
  EXPECT_THAT(WriteRefusal(SomeBone(), twice).Text(), HasSubstr("the key seed a second time"));
}

TEST_F(PackingFileTest, AFailedWriteIsReportedAndKeepsTheOldFile) {
  const auto full = WritePackingFile("/dev/full", SomeBone(), SomeProvenance());
  ASSERT_FALSE(full);
  EXPECT_THAT(full.error().Text(),
              HasSubstr("/dev/full: byte 0: cannot be written: found No space left on device"));
  struct stat status {};
  ASSERT_EQ(stat("/dev/full", &status), 0);
  EXPECT_TRUE(S_ISCHR(status.st_mode)) << "written to, not replaced";

  const auto nowhere = WritePackingFile(Path("none") / "bone.osp", SomeBone(), SomeProvenance());
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().Text(),
              HasSubstr("bone.osp: cannot be written: found No such file or directory"));
  const auto folder = WritePackingFile(folder_.path(), SomeBone(), SomeProvenance());
  ASSERT_FALSE(folder);
  EXPECT_THAT(folder.error().Text(), HasSubstr("Is a directory"));

  // a file that may not grow: the old file stays, and no partial file is left
  const std::string before = Saved(SomeBone());
  rlimit whole{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &whole), 0);
  const auto on_too_large = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{.rlim_cur = 64, .rlim_max = whole.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const bool written = WritePackingFile(Path(), SomeBone(3, 3), SomeProvenance()).has_value();
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &whole), 0);
  std::signal(SIGXFSZ, on_too_large);
  EXPECT_FALSE(written);
  EXPECT_TRUE(ReadAll(Path()) == before);
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
    EXPECT_EQ(entry.path().filename().string().find("bone.osp."), std::string::npos) << entry.path();
}

TEST_F(PackingFileTest, SavingFollowsASymbolicLink) {
  Saved(SomeBone());
  std::filesystem::create_symlink(Path(), Path("link.osp"));
  ASSERT_TRUE(WritePackingFile(Path("link.osp"), SomeBone(3, 3), SomeProvenance()));
  EXPECT_TRUE(std::filesystem::is_symlink(Path("link.osp")));
  const auto file = PackingFile::Open(Path());
  ASSERT_TRUE(file);
  EXPECT_EQ(file->balls().size(), 3u);
}

}  // namespace
}  // namespace osteon::simulation
