#include "config/reading/strict/reader.h"

#include <numbers>

#include <gtest/gtest.h>

#include "config/reading/strict/nearest_key.h"
#include "config/reading/strict/units.h"

// Tests the strict YAML reader: units that follow from the keys' endings, ranges, unknown and missing keys,
// and the text of each error (file, line, value found, values accepted).

namespace osteon::config {
namespace {

constexpr const char* kFile = "config/tools/reamer.yaml";

// The error of `read`, or of finishing the reader afterwards; empty if there is none.
template <typename Read>
std::string ErrorOf(const std::string& text, Read read) {
  try {
    Reader reader = Reader::Parse(text, kFile);
    read(reader);
    reader.Finish();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

void ReadRadius(Reader& reader) { static_cast<void>(reader.Number("radius_mm", 1, 100)); }

TEST(UnitsTest, TheEndingOfAKeyIsItsUnit) {
  EXPECT_EQ(UnitOf("radius_mm"), 1e-3);
  EXPECT_EQ(UnitOf("mm"), 1e-3);
  EXPECT_EQ(UnitOf("rate_hz"), 1.0);
  EXPECT_EQ(UnitOf("stiffness_N_per_mm"), 1e3) << "the longest ending counts, not _mm";
  EXPECT_EQ(UnitOf("cutting_energy_J_per_mm3"), 1e9);
  EXPECT_EQ(UnitOf("density_g_per_cm3"), 1e3);
  EXPECT_EQ(UnitEnding("edge_force_N_per_mm"), "N_per_mm") << "as a schema names it";
  EXPECT_DOUBLE_EQ(UnitOf("spindle_rpm").value(), 2.0 * std::numbers::pi / 60.0);
  EXPECT_DOUBLE_EQ(UnitOf("turn_deg_per_s").value(), std::numbers::pi / 180.0);
  EXPECT_FALSE(UnitOf("radius"));
  EXPECT_FALSE(UnitOf("alarm")) << "m is no unit without its underscore";
  EXPECT_FALSE(UnitOf("radius_"));
  EXPECT_FALSE(UnitOf(""));
}

TEST(NearestKeyTest, CountsSwappedLettersAsOneEdit) {
  EXPECT_EQ(NearestKey("raduis_mm", {"length_mm", "radius_mm"}), "radius_mm");
  EXPECT_EQ(NearestKey("radius", {"radius_mm"}), "");
  EXPECT_EQ(NearestKey("speed", {"radius_mm", "law"}), "");
  EXPECT_EQ(NearestKey("anything", {}), "");
}

TEST(ReaderTest, NumbersAreConvertedToSi) {
  Reader reader =
      Reader::Parse("radius_mm: 25\ntilt_deg: 90\nport: 30200\npoint_mm: [1, -2, .5e1]\non: true\n", kFile);
  EXPECT_DOUBLE_EQ(reader.Number("radius_mm", 1, 100), 0.025);
  EXPECT_DOUBLE_EQ(reader.Number("tilt_deg", -90, 90), std::numbers::pi / 2.0);
  EXPECT_EQ(reader.WholeNumber("port", 1, 65535), 30200);
  EXPECT_LT((reader.Triple("point_mm", -5, 5) - Vector3(0.001, -0.002, 0.005)).norm(), 1e-18);
  EXPECT_TRUE(reader.Bool("on"));
  EXPECT_NO_THROW(reader.Finish());
}

TEST(ReaderTest, NumberOutOfRangeNamesFileLineKeyAndRange) {
  EXPECT_EQ(ErrorOf("\n\n\n\n\n\nradius_mm: -25\n", ReadRadius),
            "config/tools/reamer.yaml:7: radius_mm: found -25, accepted 1 … 100");
}

TEST(ReaderTest, AValueThatIsNoNumberIsShownAsWritten) {
  const auto error = [](const std::string& value) {
    return ErrorOf("radius_mm: " + value + "\n", ReadRadius);
  };
  const auto expected = [](const std::string& found) {
    return std::string(kFile) + ":1: radius_mm: found " + found + ", accepted 1 … 100";
  };
  EXPECT_EQ(error("wide"), expected("wide"));
  EXPECT_EQ(error("25 mm"), expected("25 mm"));
  EXPECT_EQ(error("\"25\""), expected("\"25\""));
  EXPECT_EQ(error("25,0"), expected("25,0"));
  EXPECT_EQ(error("0x19"), expected("0x19"));
  for (const char* value : {".nan", "nan", ".inf", "inf", "-.inf", "1e999", "NaN"})
    EXPECT_EQ(error(value), expected(value)) << "not finite";
  EXPECT_EQ(error("[25]"), expected("a list of 1"));
  EXPECT_EQ(error("{a: 1}"), expected("a mapping"));
  EXPECT_EQ(error(""), expected("nothing"));
  EXPECT_EQ(error("25"), "");
}

TEST(ReaderTest, UnknownKeyComesWithTheNearestKnownOne) {
  EXPECT_EQ(ErrorOf("raduis_mm: 25\n", ReadRadius),
            "config/tools/reamer.yaml:1: unknown key \"raduis_mm\"; did you mean \"radius_mm\"?");
  EXPECT_EQ(ErrorOf("radius_mm: 25\ncolour: red\n", ReadRadius),
            "config/tools/reamer.yaml:2: unknown key \"colour\", accepted radius_mm");
  // the suggestion for a misspelled key is a key that the file lacks, even if a key that the file has is
  // spelt more similarly
  const auto read_both = [](Reader& reader) {
    static_cast<void>(reader.Number("stiffness_N_per_m", 1, 100));
    static_cast<void>(reader.Number("stiffness_N_per_mm", 1, 100));
  };
  EXPECT_EQ(ErrorOf("stiffness_N_per_mm: 2\nstifness_N_per_mm: 3\n", read_both),
            "config/tools/reamer.yaml:2: unknown key \"stifness_N_per_mm\"; did you mean "
            "\"stiffness_N_per_m\"?");
}

TEST(ReaderTest, MissingKeyNamesWhatIsAccepted) {
  const auto read = [](Reader& reader) {
    Reader head = reader.Section("head");
    EXPECT_DOUBLE_EQ(head.Number("radius_mm", 1, 100), 0.001)
        << "a value that is accepted, until Finish() throws";
    static_cast<void>(reader.Text("name"));
  };
  EXPECT_EQ(ErrorOf("# tool\nname: a\nhead: {}\n", read),
            "config/tools/reamer.yaml:3: missing key \"radius_mm\", accepted 1 … 100");
  EXPECT_EQ(ErrorOf("# tool\nname: a\n", read),
            "config/tools/reamer.yaml:2: missing key \"head\", accepted a mapping");
  EXPECT_EQ(ErrorOf("name: a\nhead:\n# end\n", read),
            "config/tools/reamer.yaml:2: head: found nothing, accepted a mapping");
}

TEST(ReaderTest, UnknownKeysInsideSectionsAndListsAreFoundByTheOuterFinish) {
  const auto read = [](Reader& reader) {
    for (Reader& joint : reader.Sections("joints", 2, 2))
      static_cast<void>(joint.Number("position_deg", 0, 180));
  };
  EXPECT_EQ(ErrorOf("joints:\n  - position_deg: 1\n  - position_deg: 2\n", read), "");
  EXPECT_EQ(ErrorOf("joints:\n  - position_deg: 1\n  - {position_deg: 2, speed_deg: 3}\n", read),
            "config/tools/reamer.yaml:3: unknown key \"speed_deg\", accepted position_deg");
  EXPECT_EQ(ErrorOf("joints:\n  - position_deg: 1\n", read),
            "config/tools/reamer.yaml:2: joints: found a list of 1, accepted a list of 2 mappings");
}

TEST(ReaderTest, TextsWordsAndListsAreChecked) {
  const auto law = [](Reader& reader) { static_cast<void>(reader.Choice("law", {"rate", "immediate"})); };
  EXPECT_EQ(ErrorOf("law: fast\n", law),
            "config/tools/reamer.yaml:1: law: found fast, accepted rate, immediate");
  const auto text = [](Reader& reader) { static_cast<void>(reader.Text("name")); };
  EXPECT_EQ(ErrorOf("name: [a]\n", text),
            "config/tools/reamer.yaml:1: name: found a list of 1, accepted a text");
  const auto triple = [](Reader& reader) { static_cast<void>(reader.Triple("p_mm", -1, 1)); };
  EXPECT_EQ(ErrorOf("p_mm: [0, 1]\n", triple),
            "config/tools/reamer.yaml:1: p_mm: found a list of 2, accepted a list of 3 numbers -1 … 1");
  EXPECT_EQ(ErrorOf("p_mm:\n - 0\n - 1\n - 7\n", triple),
            "config/tools/reamer.yaml:4: p_mm: found 7, accepted -1 … 1");
  const auto direction = [](Reader& reader) { static_cast<void>(reader.Direction("n_axis")); };
  EXPECT_EQ(ErrorOf("n_axis: [0, 0, 0.5]\n", direction),
            "config/tools/reamer.yaml:1: n_axis: found a length of 0.5, accepted 1");
  const auto whole = [](Reader& reader) { static_cast<void>(reader.WholeNumber("port", 1024, 65535)); };
  EXPECT_EQ(ErrorOf("port: 80\n", whole),
            "config/tools/reamer.yaml:1: port: found 80, accepted a whole number 1024 … 65535");
  EXPECT_EQ(ErrorOf("port: 2000.5\n", whole),
            "config/tools/reamer.yaml:1: port: found 2000.5, accepted a whole number 1024 … 65535");
  EXPECT_EQ(ErrorOf("port: 99999999999\n", whole),
            "config/tools/reamer.yaml:1: port: found 99999999999, accepted a whole number 1024 … 65535");
  const auto file = [](Reader& reader) { static_cast<void>(reader.File("robot")); };
  EXPECT_EQ(ErrorOf("robot: ../none.yaml\n", file),
            "config/tools/reamer.yaml:1: robot: found ../none.yaml, accepted an existing file (there is no "
            "config/none.yaml)");
}

TEST(ReaderTest, FilesThatAreNoMappingAreRefused) {
  const auto nothing = [](Reader&) {};
  EXPECT_EQ(ErrorOf("- 1\n- 2\n", nothing),
            "config/tools/reamer.yaml:1: found a list of 2, accepted a mapping");
  EXPECT_EQ(ErrorOf("", nothing), "config/tools/reamer.yaml: found 0 documents, accepted 1");
  EXPECT_EQ(ErrorOf("a: 1\n---\nb: 2\n", nothing), "config/tools/reamer.yaml: found 2 documents, accepted 1");
  for (const char* endless : {", a\n", "# c\n, a: 1\n", "]\n", "}\n"}) {
    const std::string error = ErrorOf(endless, nothing);
    EXPECT_NE(error.find("not YAML: "), std::string::npos) << endless << error;
  }
  EXPECT_EQ(ErrorOf("a: 1\nb: 2\na: 3\n", nothing),
            "config/tools/reamer.yaml:3: key \"a\" again, first in line 1");
  EXPECT_EQ(ErrorOf("[1, 2]: 3\n", nothing), "config/tools/reamer.yaml:1: a key must be a word");
  const std::string syntax = ErrorOf("a: 1\nb: [1, 2\n", nothing);
  EXPECT_TRUE(syntax.starts_with("config/tools/reamer.yaml:3: not YAML: ")) << syntax;
}

TEST(ReaderTest, ATabUsedToIndentIsNamedInTheError) {
  const auto nothing = [](Reader&) {};
  for (const auto& [text, line] : {std::pair{"a:\n\tb: 1\n", 2},
                                   {"a:\n  b: 1\n\tc: 2\n", 3},
                                   {"\ta: 1\n", 1},
                                   {"a:\n  - 1\n\t- 2\n", 3},
                                   {"a:\n  b: 1\n  \tc: 2\n", 3}})
    EXPECT_EQ(ErrorOf(text, nothing), "config/tools/reamer.yaml:" + std::to_string(line) +
                                          ": not YAML: found a tab before the text, accepted blanks alone")
        << text;
  // a tab that does not indent counts as a space, so the error is about the open list and not about a tab
  EXPECT_EQ(ErrorOf("a: [1,\n\t2]\nb: [1, 2\n", nothing).find("tab"), std::string::npos);
  EXPECT_EQ(ErrorOf("a:\tb\n", [](Reader& reader) { EXPECT_EQ(reader.Text("a"), "b"); }), "");
}

TEST(ReaderTest, AControlCharacterIsNamedInTheError) {
  const auto nothing = [](Reader&) {};
  EXPECT_EQ(ErrorOf(std::string("a: 1\nb: \0\n", 10), nothing),
            "config/tools/reamer.yaml:2: not YAML: found the byte 0x00, accepted text in UTF-8");
  EXPECT_EQ(ErrorOf("a: \x1b[2J\n", nothing),
            "config/tools/reamer.yaml:1: not YAML: found the byte 0x1b, accepted text in UTF-8");
  EXPECT_EQ(ErrorOf("a: b\r\n", [](Reader& reader) { EXPECT_EQ(reader.Text("a"), "b"); }), "");
}

TEST(ReaderTest, AMissingFileAFolderAndADeviceAreRefused) {
  const auto error_of = [](const char* path) -> std::string {
    try {
      static_cast<void>(Reader::Load(path));
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.line(), 0);
      EXPECT_EQ(error.file(), path);
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(error_of("no/such.yaml"), "no/such.yaml: no such file");
  EXPECT_EQ(error_of("/"), "/: found a folder, accepted a file");
  EXPECT_EQ(error_of("/dev/null"), "/dev/null: found a pipe, a socket or a device, accepted a file");
}

TEST(ReaderTest, AnAnchoredMappingCanBeReadTwice) {
  Reader reader = Reader::Parse("a: &here {radius_mm: 3}\nb: *here\n", kFile);
  EXPECT_DOUBLE_EQ(reader.Section("a").Number("radius_mm", 1, 9), 0.003);
  EXPECT_DOUBLE_EQ(reader.Section("b").Number("radius_mm", 1, 9), 0.003);
  EXPECT_NO_THROW(reader.Finish());
}

TEST(ReaderTest, AskingForAKeyWithoutUnitIsALogicError) {
  Reader reader = Reader::Parse("radius: 3\n", kFile);
  EXPECT_THROW(static_cast<void>(reader.Number("radius", 1, 9)), std::logic_error);
}

}  // namespace
}  // namespace osteon::config
