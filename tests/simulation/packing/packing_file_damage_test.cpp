#include "simulation/packing/packing_file.h"

#include <functional>
#include <limits>
#include <set>

#include <gmock/gmock.h>

#include "tests/simulation/packing/packing_file_fixture.h"

// Tests of damaged packing files: each damage is refused with its byte, what was found and what is accepted.

namespace osteon::simulation {
namespace {

using io::test::WriteAll;
using testing::HasSubstr;
using namespace test;

/// A kind of damage with the error that it must give.
struct Malformed {
  const char* name;
  std::function<void(std::string&)> damage;  ///< applied to a valid file
  std::vector<std::string> message;          ///< parts of the error
};

/// A valid entry of the section "materials".
std::string MaterialLines(const std::string& name) {
  return "material=" + name +
         "\ndensity_kg_per_m3=1000\ndensity_source=weighed\nspecific_cutting_energy_J_per_m3=1e9\n"
         "cutting_energy_assumption=\ncutting_force_ratio=0.8\ncutting_force_assumption=as "
         "bone\nfriction=0.2\n"
         "friction_assumption=\n";
}

/// The part of an error that names a byte of the file.
std::string At(std::size_t byte) { return ": byte " + std::to_string(byte) + ": "; }

/// Damages of the valid file `good`. The lambdas below each make one kind of change.
std::vector<Malformed> MalformedFiles(const std::string& good) {
  const auto section = [&good](std::size_t i) { return SectionAt(good, i); };
  /// Changes a field of the table and recomputes the checksum.
  const auto entry = [](std::size_t i, const std::string& field, auto value) {
    return [=](std::string& bytes) {
      Put(bytes, EntryAt(i, field), value);
      SealHeader(bytes);
    };
  };
  /// Changes bytes of a section and recomputes the checksum.
  const auto within = [](std::size_t at, auto value) {
    return [=](std::string& bytes) {
      Put(bytes, at, value);
      Seal(bytes);
    };
  };
  /// Flips a bit and leaves the checksum.
  const auto flipped = [](std::size_t at) {
    return [at](std::string& bytes) { bytes[at] = static_cast<char>(bytes[at] ^ 0x10); };
  };
  /// Replaces a text by another of equal length and recomputes the checksum.
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
  /// Changes the content of a section and recomputes table and checksums.
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

TEST_F(PackingFileTest, AFlippedBitInAnyByteOfHeaderAndTableIsDetected) {
  const std::string good = Saved(SomeBone(2, 2));
  for (std::size_t at = 0; at < 64 + 6 * 32; ++at) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << at % 8));
    WriteAll(Path("bad.osp"), bytes);
    ASSERT_FALSE(PackingFile::Open(Path("bad.osp"))) << "byte " << at;
  }
}

TEST_F(PackingFileTest, PathsThatAreNoRegularFileAreRefused) {
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

}  // namespace
}  // namespace osteon::simulation
