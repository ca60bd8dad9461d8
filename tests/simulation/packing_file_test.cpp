#include "simulation/packing_file.h"

#include <sys/stat.h>

#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <sstream>

#include <gmock/gmock.h>

#include "simulation/packing_export.h"
#include "tests/io/temporary_folder.h"
#include "tests/simulation/packing_samples.h"

namespace osteon::simulation {
namespace {

using io::test::ReadAll;
using io::test::TemporaryFolder;
using io::test::WriteAll;
using testing::HasSubstr;
using namespace test;

// Order of the sections of a file with all of them.
constexpr std::size_t kBallSection = 0, kPointSection = 1, kPointMaterialSection = 2, kMaterialSection = 3,
                      kSiteSection = 4, kProvenanceSection = 5;

/// 2^-15 mm, the grid of docs/packing.md.
constexpr double kGrid_m = 1e-3 / 32768.0;

class PackingFileTest : public testing::Test {
 protected:
  std::filesystem::path Path(const std::string& name = "bone.osp") const { return folder_.path() / name; }

  std::string Saved(const Bone& bone, const PackingProvenance& provenance = SomeProvenance()) {
    const auto written = WritePackingFile(Path(), bone, provenance);
    EXPECT_TRUE(written) << written.error().Text();
    return ReadAll(Path());
  }

  FileError Refusal(const std::string& bytes) {
    WriteAll(Path("bad.osp"), bytes);
    const auto file = PackingFile::Open(Path("bad.osp"));
    if (file) ADD_FAILURE() << "the file was accepted";
    return file ? FileError{} : file.error();
  }

  FileError WriteRefusal(const Bone& bone, const PackingProvenance& provenance = SomeProvenance()) {
    const auto written = WritePackingFile(Path("refused.osp"), bone, provenance);
    if (written) ADD_FAILURE() << "the bone was accepted";
    EXPECT_FALSE(std::filesystem::exists(Path("refused.osp")));
    return written ? FileError{} : written.error();
  }

  TemporaryFolder folder_;
};

TEST_F(PackingFileTest, WhatIsSavedIsWhatIsLoaded) {
  const Bone bone = SomeBone();
  Saved(bone);
  const auto file = PackingFile::Open(Path());
  ASSERT_TRUE(file) << file.error().Text();
  const Bone loaded = file->ToBone();
  ASSERT_EQ(loaded.balls.size(), bone.balls.size());
  ASSERT_EQ(loaded.points.size(), bone.points.size());
  for (std::size_t i = 0; i < bone.points.size(); ++i) {
    // half a grid along each axis, and the rounding of the volume to float32
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
    for (const auto source : {&Material::density_source, &Material::cutting_energy_source,
                              &Material::cutting_force_source, &Material::friction_source}) {
      EXPECT_EQ((loaded.materials[i].*source).text, (bone.materials[i].*source).text);
      EXPECT_EQ((loaded.materials[i].*source).assumed, (bone.materials[i].*source).assumed);
    }
  }
  EXPECT_EQ(Vector3(loaded.cup.center_m), Vector3(bone.cup.center_m));
  EXPECT_EQ(Vector3(loaded.cup.axis), Vector3(bone.cup.axis));
  EXPECT_EQ(loaded.cup.radius_m, bone.cup.radius_m);
  EXPECT_EQ(loaded.name, bone.name);
  EXPECT_EQ(file->provenance(), SomeProvenance());
}

// Neither protrusion nor overlap may grow by what saving rounds.
TEST_F(PackingFileTest, EachBallSavedLiesWithinTheBallGiven) {
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
    // half a diagonal of the grid for the centre, that and a step for the radius
    EXPECT_LE(moved_m, 0.867 * kGrid_m);
    EXPECT_GE(loaded.balls[i].radius_m, bone.balls[i].radius_m - 1.867 * kGrid_m);
  }
}

TEST_F(PackingFileTest, ALoadedPackingSavesToTheSameBytes) {
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

TEST_F(PackingFileTest, AZeroLosesItsSign) {
  Bone bone = SomeBone(3, 2);
  // rounds to minus zero on the grid, and the origin is zero
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

// The middle of these lies on half a millimetre, where rounding it could go either way.
TEST_F(PackingFileTest, TheOriginOfASymmetricPackingStaysWhenItIsSavedAgain) {
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

TEST_F(PackingFileTest, TheBytesLieWhereTheFormatSays) {
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
  // what the test's own hands seal is what the writer sealed
  std::string sealed = bytes;
  Seal(sealed);
  EXPECT_TRUE(sealed == bytes);
}

TEST_F(PackingFileTest, PointsAndSiteMayBeAbsent) {
  Bone bone = SomeBone(5, 0);
  bone.cup.radius_m = 0.0;
  Saved(bone);
  const auto file = PackingFile::Open(Path());
  ASSERT_TRUE(file) << file.error().Text();
  EXPECT_FALSE(file->site());
  EXPECT_TRUE(file->points().empty());
  EXPECT_EQ(file->ToBone().cup.radius_m, 0.0);
}

/// The file's bytes are the same however many threads read it, and so is the verdict.
TEST_F(PackingFileTest, TheFirstBadBallIsNamedForAnyNumberOfThreads) {
  std::string bytes = Saved(SomeBone(200'000, 0));  // three pieces of a mebibyte, and a rest
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

TEST_F(PackingFileTest, AMappedFileOutlivesItsReplacement) {
  Saved(SomeBone(10, 5));
  const auto file = PackingFile::Open(Path());
  ASSERT_TRUE(file);
  const float x = file->balls().front().x_mm;
  Saved(SomeBone(3, 1));
  EXPECT_EQ(file->balls().size(), 10u);
  EXPECT_EQ(file->balls().front().x_mm, x);
}

struct Malformed {
  const char* name;
  std::function<void(std::string&)> damage;  ///< of a good file
  std::vector<std::string> message;          ///< parts of the answer
};

std::string MaterialLines(const std::string& name) {
  return "material=" + name +
         "\ndensity_kg_per_m3=1000\ndensity_source=weighed\nspecific_cutting_energy_J_per_m3=1e9\n"
         "cutting_energy_assumption=\ncutting_force_ratio=0.8\ncutting_force_assumption=as "
         "bone\nfriction=0.2\n"
         "friction_assumption=\n";
}

std::string At(std::size_t byte) { return ": byte " + std::to_string(byte) + ": "; }

std::vector<Malformed> MalformedFiles(const std::string& good) {
  const auto section = [&good](std::size_t i) { return SectionAt(good, i); };
  /// Changes a field of the table, and seals it.
  const auto entry = [](std::size_t i, const std::string& field, auto value) {
    return [=](std::string& bytes) {
      Put(bytes, EntryAt(i, field), value);
      SealHeader(bytes);
    };
  };
  /// Changes bytes of a section, and seals it.
  const auto within = [](std::size_t at, auto value) {
    return [=](std::string& bytes) {
      Put(bytes, at, value);
      Seal(bytes);
    };
  };
  const auto flipped = [](std::size_t at) {
    return [at](std::string& bytes) { bytes[at] = static_cast<char>(bytes[at] ^ 0x10); };
  };
  const auto text = [](const std::string& from, const std::string& to) {
    return [=](std::string& bytes) {
      ASSERT_EQ(from.size(), to.size());
      ASSERT_NE(bytes.find(from), std::string::npos);
      bytes.replace(bytes.find(from), from.size(), to);
      Seal(bytes);
    };
  };
  const auto cut = [](std::size_t at) { return [at](std::string& bytes) { bytes.resize(at); }; };
  const auto becomes = [](const std::string& other) {
    return [other](std::string& bytes) { bytes = other; };
  };
  const auto with = [](std::size_t i, const std::function<void(std::string&)>& change) {
    return [=](std::string& bytes) {
      auto sections = Sections(bytes);
      change(sections[i].content);
      sections[i].count = sections[i].content.size();
      bytes = Compose(bytes, sections);
    };
  };
  const auto without = [](std::size_t i) {
    return [i](std::string& bytes) {
      auto sections = Sections(bytes);
      sections.erase(sections.begin() + static_cast<std::ptrdiff_t>(i));
      bytes = Compose(bytes, sections);
    };
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::uint64_t kHuge = ~std::uint64_t{0};

  return {
      {"empty", becomes(""), {": found an empty file"}},
      {"a PNG picture",
       becomes("\x89PNG\r\n\x1a\n and so on"),
       {At(0), "89 50 4e 47 0d 0a 1a 0a (a PNG picture)", "89 4f 53 50"}},
      {"a mesh",
       becomes("solid cube\nfacet normal 0 0 1\n"),
       {At(0), "(an STL mesh as text)", "89 4f 53 50"}},
      {"a PLY export", becomes("ply\nformat ascii 1.0\n"), {At(0), "(a PLY file)"}},
      {"zeros",
       becomes(std::string(4096, '\0')),
       {At(0), "found 00 00 00 00 00 00 00 00, accepted a packing file"}},
      {"text mode", [](std::string& bytes) { bytes.erase(4, 1); }, {At(0), "transfer in text mode"}},
      {"cut off in the magic", cut(5), {At(5), "header: found the end of the file"}},
      {"cut off in the header", cut(40), {At(40), "header: found the end of the file", "64 bytes"}},
      {"cut off in the table",
       cut(100),
       {At(100), "section table: found the end of the file", "6 sections of 32 bytes"}},
      {"cut off in the balls",
       cut(section(0) + 100),
       {At(section(0) + 100), "section \"balls\": found the end of the file"}},
      {"cut off in the last section",
       cut(good.size() - 1),
       {At(good.size() - 1), "section \"provenance\": found the end"}},
      {"bytes behind it",
       [](std::string& bytes) { bytes += "more"; },
       {At(good.size()), "found 4 bytes more"}},
      {"big-endian",
       [](std::string& bytes) { std::reverse(bytes.begin() + 8, bytes.begin() + 12); },
       {At(8), "byte order: found 01 02 03 04 (big-endian)", "04 03 02 01"}},
      {"middle-endian",
       within(8, std::uint32_t{0x02010403}),
       {At(8), "byte order: found 03 04 01 02, accepted"}},
      {"a newer version",
       within(12, std::uint32_t{2}),
       {At(12), "version: found 2, accepted 1: a newer Osteon"}},
      {"version 0", within(12, std::uint32_t{0}), {At(12), "version: found 0, accepted 1"}},
      {"no sections", within(24, std::uint32_t{0}), {At(24), "number of sections: found 0, accepted 1 … 16"}},
      {"many sections",
       [](std::string& bytes) { Put(bytes, 24, ~std::uint32_t{0}); },
       {At(24), "number of sections: found 4294967295"}},
      {"a bit of the origin", flipped(35), {At(60), "checksum of header and section table"}},
      {"a bit of the table", flipped(90), {At(60), "checksum of header and section table"}},
      {"a reserved word",
       [](std::string& bytes) {
         Put(bytes, 28, 7);
         SealHeader(bytes);
       },
       {At(28), "header: found 7, accepted 0"}},
      {"an origin that is none",
       [](std::string& bytes) {
         Put(bytes, 40, std::nan(""));
         SealHeader(bytes);
       },
       {At(40), "origin: found nan mm"}},
      {"a bit of the balls",
       flipped(section(0) + 77),
       {At(section(0)), "checksum of section \"balls\"", "were changed"}},
      {"a bit of the points",
       flipped(section(1) + 5),
       {At(section(1)), "checksum of section \"mass points\""}},
      {"a bit of the points' materials",
       flipped(section(2)),
       {At(section(2)), "checksum of section \"materials of the points\""}},
      {"a bit of the materials",
       flipped(section(3) + 30),
       {At(section(3)), "checksum of section \"materials\""}},
      {"a bit of the site", flipped(section(4) + 30), {At(section(4)), "checksum of section \"site\""}},
      {"a bit of the provenance",
       flipped(section(5) + 30),
       {At(section(5)), "checksum of section \"provenance\""}},
      {"a bit between sections",
       flipped(section(5) - 1),
       {At(section(5) - 1), "before section \"provenance\": found 10, accepted 00"}},
      {"a section behind the end",
       entry(0, "offset", std::uint64_t{1} << 20),
       {At(EntryAt(0, "offset")), "section \"balls\"", "from byte 1048576 on", "within the file's"}},
      {"offset and size that overflow",
       entry(0, "bytes", kHuge),
       {At(EntryAt(0, "offset")), "found 18446744073709551615 bytes"}},
      {"an offset that overflows",
       entry(1, "offset", kHuge - 63),
       {At(EntryAt(1, "offset")), "section \"mass points\"", "from byte 18446744073709551552 on"}},
      {"overlapping sections",
       entry(1, "offset", std::uint64_t{section(0)}),
       {At(EntryAt(1, "offset")), "section \"mass points\": found that it begins at byte " +
                                      std::to_string(section(0)) + ", within what lies before it"}},
      {"a section upon the table",
       entry(0, "offset", std::uint64_t{64}),
       {At(EntryAt(0, "offset")), "section \"balls\": found that it begins at byte 64, within"}},
      {"a crooked offset",
       entry(0, "offset", std::uint64_t{section(0) + 4}),
       {At(EntryAt(0, "offset")), "a multiple of 64"}},
      {"a gap",
       entry(0, "offset", std::uint64_t{section(0) + 64}),
       {At(EntryAt(0, "offset")), "a gap before it"}},
      {"a ball more than there is",
       entry(0, "count", std::uint64_t{41}),
       {At(EntryAt(0, "count")), "found 41 records in 640 bytes, accepted 16 bytes a record"}},
      {"a count that overflows to the right one",
       entry(0, "count", (std::uint64_t{1} << 60) + 40),
       {At(EntryAt(0, "count")), "1152921504606847016 records in 640 bytes"}},
      {"half a ball",
       entry(0, "bytes", std::uint64_t{632}),
       {At(EntryAt(0, "count")), "40 records in 632 bytes"}},
      {"no ball",
       [&](std::string& bytes) {
         Put(bytes, EntryAt(0, "count"), std::uint64_t{0});
         Put(bytes, EntryAt(0, "bytes"), std::uint64_t{0});
         SealHeader(bytes);
       },
       {At(EntryAt(0, "count")), "section \"balls\": found 0 records, accepted 1 and more"}},
      {"two sites",
       [&](std::string& bytes) {
         Put(bytes, EntryAt(kSiteSection, "count"), std::uint64_t{2});
         SealHeader(bytes);
       },
       {"section \"site\": found 2 records, accepted 1 … 1"}},
      {"an unknown section",
       entry(5, "kind", std::uint32_t{99}),
       {At(EntryAt(5)), "section 5: found kind 99, accepted 1 … 6"}},
      {"a section twice",
       entry(1, "kind", std::uint32_t{1}),
       {At(EntryAt(1)), "section \"balls\": found a second one"}},
      {"sections out of order", entry(4, "kind", std::uint32_t{2}), {At(EntryAt(4)), "one of each kind"}},
      {"the size in the header",
       [](std::string& bytes) {
         Put(bytes, 16, Get<std::uint64_t>(bytes, 16) + 64);
         SealHeader(bytes);
       },
       {At(16), "size of the file", "the end of the last section"}},
      {"NaN in a ball",
       within(section(0) + 16 * 3 + 4, kNan),
       {At(section(0) + 16 * 3 + 4), "ball 3: y: found nan mm, accepted -512 … 512 mm"}},
      {"an infinite ball",
       within(section(0) + 16 * 3, std::numeric_limits<float>::infinity()),
       {At(section(0) + 48), "ball 3: x: found inf mm"}},
      {"a ball far away", within(section(0) + 16 * 39 + 8, 513.0f), {"ball 39: z: found 513 mm"}},
      {"a negative radius",
       within(section(0) + 16 * 3 + 12, -1.0f),
       {At(section(0) + 60), "ball 3: radius: found -1 mm, accepted above 0, up to 512 mm"}},
      {"a radius of zero", within(section(0) + 12, 0.0f), {"ball 0: radius: found 0 mm"}},
      {"a NaN radius", within(section(0) + 12, kNan), {"ball 0: radius: found nan mm"}},
      {"NaN in a point",
       within(section(1) + 16 * 2, kNan),
       {At(section(1) + 32), "mass point 2: x: found nan mm"}},
      {"a volume of zero",
       within(section(1) + 16 * 2 + 12, 0.0f),
       {At(section(1) + 44), "mass point 2: volume: found 0 mm^3, accepted above 0"}},
      {"a negative volume", within(section(1) + 12, -0.5f), {"mass point 0: volume: found -0.5 mm^3"}},
      {"a material that is not listed",
       within(section(2) + 6, MaterialIndex{3}),
       {At(section(2) + 6), "mass point 6: found material 3, accepted 0 … 2: 3 materials are listed"}},
      {"a figure that is none",
       text("friction=0.2", "friction=-.2"),
       {"section \"materials\": friction: found \"-.2\", accepted 0 … 2"}},
      {"a figure that is words", text("friction=0.2", "friction=abc"), {"friction: found \"abc\""}},
      {"a source that is neither",
       text("friction_assumption=", "friction_assumptiom="),
       {"found a line \"friction_assumptiom\", accepted a line friction_source=… or friction_assumption=…"}},
      {"an unknown line",
       text("friction=0.2", "frictiom=0.2"),
       {"found a line \"frictiom\", accepted a line friction=…"}},
      {"bytes that are no text", text("dentine", "dent\xffne"), {"found \"\\xff\", accepted UTF-8"}},
      {"a control character",
       text("dentine", "dent\x1bne"),
       {"found \"\\x1b\", accepted UTF-8 without control characters"}},
      {"a lone backslash", text("a \\\\ of", "a \\x of"), {"found \"\\x\", accepted \\\\ or \\n"}},
      {"a crooked axis", within(section(4) + 24, 0.9), {At(section(4) + 24), "site: axis", "a length of 1"}},
      {"a site without a radius",
       within(section(4) + 48, -0.02),
       {At(section(4) + 48), "site: radius: found -0.02 m"}},
      {"a site nowhere", within(section(4) + 8, std::nan("")), {At(section(4)), "site: centre"}},
      {"a checksum that is none",
       text("00beef42", "00beef4x"),
       {"source_crc32: found \"00beef4x\", accepted 8 hexadecimal digits"}},
      {"a key twice", text("seed=7", "mode=7"), {"section \"provenance\": found the key mode a second time"}},
      {"a key with a blank", text("seed=7", "se d=7"), {"a key \"se d\""}},
      {"no balls", without(kBallSection), {At(64), "found no section \"balls\""}},
      {"no materials", without(kMaterialSection), {At(64), "found no section \"materials\""}},
      {"no provenance", without(kProvenanceSection), {At(64), "found no section \"provenance\""}},
      {"points without materials",
       without(kPointMaterialSection),
       {At(64), "found 25 mass points with 0 materials"}},
      {"materials without points", without(kPointSection), {At(64), "found 0 mass points with 25 materials"}},
      {"nine materials",
       with(kMaterialSection,
            [](std::string& content) {
              for (int i = 0; i < 6; ++i) content += MaterialLines("tissue " + std::to_string(i));
            }),
       {"section \"materials\": found a material more, accepted 1 … 8 materials"}},
      {"a material twice",
       with(kMaterialSection, [](std::string& content) { content += MaterialLines("pulp"); }),
       {"material: found \"pulp\" a second time"}},
      {"a material without a name",
       with(kMaterialSection, [](std::string& content) { content += MaterialLines(""); }),
       {"material: found no name"}},
      {"a text without an end",
       with(kProvenanceSection,
            [](std::string& content) { content += "long=" + std::string(1 << 20, 'x') + "\n"; }),
       {"section \"provenance\": found 1048", "accepted 1 … 1048576"}},
      {"no end of the last line",
       [](std::string& bytes) {
         bytes.back() = 'x';
         Seal(bytes);
       },
       {"found a line without its end"}},
  };
}

TEST_F(PackingFileTest, EveryMalformedFileIsRefusedWithByteAndReason) {
  const std::string good = Saved(SomeBone());
  ASSERT_TRUE(Compose(good, Sections(good)) == good) << "the test's own hands know the layout";
  std::set<std::string> answers;
  const auto cases = MalformedFiles(good);
  for (const Malformed& each : cases) {
    SCOPED_TRACE(each.name);
    std::string bytes = good;
    each.damage(bytes);
    ASSERT_TRUE(bytes != good);
    const FileError error = Refusal(bytes);
    const std::string text = error.Text();
    EXPECT_TRUE(text.starts_with(Path("bad.osp").string() + ": ")) << text;
    EXPECT_EQ(std::ranges::count(text, '\n'), 0) << text;
    EXPECT_TRUE(error.byte || bytes.empty()) << text;
    if (error.byte) {
      EXPECT_LE(*error.byte, bytes.size()) << text;
    }
    for (const std::string& part : each.message) EXPECT_THAT(text, HasSubstr(part));
    EXPECT_TRUE(answers.insert(text).second) << "the same answer as another case: " << text;
  }
  EXPECT_GE(cases.size(), 60u);
}

TEST_F(PackingFileTest, AFlippedBitOfHeaderAndTableIsSeenInEachOfTheirBytes) {
  const std::string good = Saved(SomeBone(2, 2));
  for (std::size_t at = 0; at < 64 + 6 * 32; ++at) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << at % 8));
    WriteAll(Path("bad.osp"), bytes);
    ASSERT_FALSE(PackingFile::Open(Path("bad.osp"))) << "byte " << at;
  }
}

TEST_F(PackingFileTest, WhatIsNoFileIsRefusedAtOnce) {
  const auto refused = [](const std::filesystem::path& path) {
    const auto file = PackingFile::Open(path);
    return file ? std::string("accepted") : file.error().Text();
  };
  EXPECT_THAT(refused(Path("nowhere.osp")), HasSubstr("nowhere.osp: found no such file"));
  EXPECT_THAT(refused(folder_.path()), HasSubstr("found a folder, accepted a regular file"));
  EXPECT_THAT(refused("/dev/zero"), HasSubstr("found a device, accepted a regular file"));
  ASSERT_EQ(mkfifo(Path("pipe.osp").c_str(), 0600), 0);
  EXPECT_THAT(refused(Path("pipe.osp")), HasSubstr("found a pipe, accepted a regular file"));
  WriteAll(Path("file"), "x");
  EXPECT_THAT(refused(Path("file") / "below.osp"), HasSubstr("Not a directory"));
}

TEST_F(PackingFileTest, ABoneThatHasNoPlaceInAFileIsRefusedAndNothingIsLeft) {
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
  EXPECT_THAT(refused([](Bone& b) { b.cup.radius_m = -1; }), HasSubstr("site: radius: found -1 m"));
  EXPECT_THAT(refused([](Bone& b) { b.cup.axis = Vector3(0, 0, 2); }),
              HasSubstr("site: axis: found (0, 0, 2)"));
  PackingProvenance twice = SomeProvenance();
  twice.parameters.emplace_back("seed", "8");
  EXPECT_THAT(WriteRefusal(SomeBone(), twice).Text(), HasSubstr("the key seed a second time"));
}

TEST_F(PackingFileTest, ADiskThatIsFullIsReportedAndTheOldFileStays) {
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

  // a temporary file that leads to the full device: what was there stays, and no half file is left
  const std::string before = Saved(SomeBone());
  std::filesystem::create_symlink("/dev/full", Path("bone.osp.part"));
  EXPECT_FALSE(WritePackingFile(Path(), SomeBone(3, 3), SomeProvenance()));
  EXPECT_TRUE(ReadAll(Path()) == before);
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(Path("bone.osp.part"))));
}

TEST_F(PackingFileTest, ASymbolicLinkIsFollowed) {
  Saved(SomeBone());
  std::filesystem::create_symlink(Path(), Path("link.osp"));
  ASSERT_TRUE(WritePackingFile(Path("link.osp"), SomeBone(3, 3), SomeProvenance()));
  EXPECT_TRUE(std::filesystem::is_symlink(Path("link.osp")));
  const auto file = PackingFile::Open(Path());
  ASSERT_TRUE(file);
  EXPECT_EQ(file->balls().size(), 3u);
}

// ---- export

TEST_F(PackingFileTest, PlyHoldsTheBallsInMillimetres) {
  const Bone bone = SomeBone();
  ASSERT_TRUE(WritePly(Path("out.ply"), bone.balls));
  const std::string bytes = ReadAll(Path("out.ply"));
  const std::string header = bytes.substr(0, bytes.find("end_header\n") + 11);
  EXPECT_TRUE(header.starts_with("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(header, HasSubstr("element vertex 40\nproperty float x\nproperty float y\nproperty float "
                                "z\nproperty float radius\n"));
  ASSERT_EQ(bytes.size(), header.size() + 16 * bone.balls.size());
  for (std::size_t i = 0; i < bone.balls.size(); ++i) {
    const std::size_t at = header.size() + 16 * i;
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_FLOAT_EQ(
          Get<float>(bytes, at + 4 * k),
          static_cast<float>(Vector3(bone.balls[i].center_m)[static_cast<Eigen::Index>(k)] * 1e3));
    EXPECT_FLOAT_EQ(Get<float>(bytes, at + 12), static_cast<float>(bone.balls[i].radius_m * 1e3));
  }
}

TEST_F(PackingFileTest, CsvHoldsTheBallsInMillimetres) {
  const Bone bone = SomeBone();
  ASSERT_TRUE(WriteCsv(Path("out.csv"), bone.balls));
  std::istringstream lines(ReadAll(Path("out.csv")));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "x_mm,y_mm,z_mm,r_mm");
  std::size_t count = 0;
  for (; std::getline(lines, line); ++count) {
    ASSERT_LT(count, bone.balls.size());
    const Ball& ball = bone.balls[count];
    double x = 0, y = 0, z = 0, r = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &x, &y, &z, &r), 4) << line;
    // float32 of up to a metre in mm
    EXPECT_LT((Vector3(x, y, z) - Vector3(ball.center_m) * 1e3).norm(), 1e-4);
    EXPECT_NEAR(r, ball.radius_m * 1e3, 1e-6);
  }
  EXPECT_EQ(count, bone.balls.size());
}

TEST_F(PackingFileTest, AnExportToAFullDiskIsReported) {
  for (const auto& written :
       {WritePly("/dev/full", SomeBone().balls), WriteCsv("/dev/full", SomeBone().balls)}) {
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().Text(), HasSubstr("No space left on device"));
  }
}

}  // namespace
}  // namespace osteon::simulation
