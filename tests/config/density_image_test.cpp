#include "config/reading/sections/density_image.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include "config/reading/load.h"
#include "simulation/bone/scenes.h"

// Tests scenes whose density comes from a grey PNG, and whose material follows from the density. The image's
// columns are heights, its rows are depths.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path kConfig = fs::path(OSTEON_SOURCE_DIR) / "config";

// A PNG file that a test writes.
struct Picture {
  std::uint32_t width{1}, height{2};
  int depth{8};  // bits per sample
  int kind{PNG_COLOR_TYPE_GRAY};
  std::vector<std::uint8_t> bytes;  // row by row as in the file; a sample of 16 bits has its high byte first
  double gamma{0.0};                // 0: the file states no gamma
};

void WritePng(const fs::path& path, const Picture& picture) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"), &std::fclose);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file.get());
  png_set_IHDR(png, info, picture.width, picture.height, picture.depth, picture.kind, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (picture.gamma > 0.0) png_set_gAMA(png, info, picture.gamma);
  png_write_info(png, info);
  const std::size_t row_bytes = png_get_rowbytes(png, info);
  ASSERT_EQ(picture.bytes.size(), row_bytes * picture.height);
  for (std::uint32_t row = 0; row < picture.height; ++row)
    png_write_row(png, picture.bytes.data() + row * row_bytes);
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
}

std::string ReadText(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

void WriteText(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

// The text with the first occurrence of `from` replaced. It must occur.
std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "the test is out of date: no " << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// A scene's section about its image: 3 rows at the depths 0, 2 and 4 mm, 2 columns at the heights 5 and 15
// mm. One grey level is 0.01 g/cm³.
constexpr const char* kImage =
    "\n  density_image:\n"
    "    file: profile.png\n"
    "    row_step_mm: 2\n"
    "    density_g_per_cm3: [0, 2.55]\n"
    "    axis: [0, 0, 1]\n"
    "    column_heights_mm: [5, 15]\n"
    "    classes:\n"
    "      - {below_g_per_cm3: 0.5, material: cancellous}\n"
    "      - {below_g_per_cm3: 1.5, material: cartilage}\n"
    "      - {material: cortical}\n";

class DensityImages : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) /
              ("osteon_density_" + std::to_string(::getpid()) + "_" + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    WritePng(picture(), {.width = 2, .height = 3, .bytes = {200, 100, 200, 100, 20, 20}});
    WriteScene(kImage);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path picture() const { return folder_ / "profile.png"; }
  [[nodiscard]] fs::path scene() const { return folder_ / "plate.yaml"; }

  /// Writes the scene thin_plate with this section about its image.
  void WriteScene(const std::string& image) const {
    WriteText(scene(), Replaced(ReadText(kConfig / "scenes/thin_plate.yaml"),
                                "\n  layers: []\n  core: cortical\n  regions",
                                "\n  layers: []\n  core: cortical" + image + "  regions"));
  }
  /// The error of loading the scene. It must name a line. "accepted" if there is no error.
  std::string Refusal() {
    try {
      static_cast<void>(LoadScene(scene()));
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.file(), scene().string());
      EXPECT_GT(error.line(), 0);
      return error.what();
    }
    return "accepted";
  }
  /// The error of loading the scene with another image.
  std::string RefusalOf(const Picture& changed) {
    WritePng(picture(), changed);
    return Refusal();
  }

  fs::path folder_;
};

TEST_F(DensityImages, PixelsOf8BitsBecomeDensities) {
  WritePng(picture(), {.width = 3, .height = 2, .bytes = {0, 7, 51, 102, 7, 255}});
  const auto tissue = LoadScene(scene()).mesh_tissue;
  ASSERT_TRUE(tissue.solid.image);
  const simulation::DensityImage& image = *tissue.solid.image;
  EXPECT_EQ(image.rows, 2);
  EXPECT_EQ(image.columns, 3);
  constexpr double kRounding = 1e-3;  // rounding error [kg/m³] of floats up to 2550 kg/m³
  EXPECT_NEAR(image.DensityAt(0.000, 0.005), 0.0, kRounding);
  EXPECT_NEAR(image.DensityAt(0.000, 0.015), 510.0, kRounding);
  EXPECT_NEAR(image.DensityAt(0.002, 0.005), 1020.0, kRounding);
  EXPECT_NEAR(image.DensityAt(0.002, 0.015), 2550.0, kRounding);
  EXPECT_NEAR(image.DensityAt(0.001, 0.010), 70.0, kRounding);
}

// A PNG's gamma concerns only its display. 0x8000 is half of the range, whatever gamma the file states.
TEST_F(DensityImages, TheGammaOfAPngChangesNoLevel) {
  for (const double gamma : {0.0, 0.45455, 1.0}) {
    WritePng(picture(), {.width = 2,
                         .height = 2,
                         .depth = 16,
                         .bytes = {0x00, 0x00, 0xff, 0xff, 0x80, 0x00, 0x00, 0x01},
                         .gamma = gamma});
    const auto grey = ReadGreyPng(picture());
    ASSERT_TRUE(grey) << grey.error();
    EXPECT_EQ(grey->level, (std::vector<float>{0.0f, 1.0f, 32768.0f / 65535.0f, 1.0f / 65535.0f})) << gamma;
    WritePng(picture(), {.width = 2, .height = 2, .bytes = {0, 255, 128, 1}, .gamma = gamma});
    const auto narrow = ReadGreyPng(picture());
    ASSERT_TRUE(narrow) << narrow.error();
    EXPECT_EQ(narrow->level, (std::vector<float>{0.0f, 1.0f, 128.0f / 255.0f, 1.0f / 255.0f})) << gamma;
  }
}

TEST_F(DensityImages, ARegionMayHaveAnImage) {
  std::string image = kImage;
  for (std::size_t at = 0; (at = image.find("\n  ", at)) != std::string::npos; at += 5)
    image.replace(at, 3, "\n      ");
  WriteText(scene(),
            Replaced(ReadText(kConfig / "scenes/thin_plate.yaml"), "\n  regions: []",
                     "\n  regions:\n    - name: inlay\n      layers: []\n      core: cortical" + image));
  const auto tissue = LoadScene(scene()).mesh_tissue;
  EXPECT_FALSE(tissue.solid.image);
  ASSERT_EQ(tissue.regions.size(), 1u);
  ASSERT_TRUE(tissue.regions[0].tissue.image);
  EXPECT_EQ(tissue.regions[0].tissue.image->rows, 3);
}

TEST_F(DensityImages, DamagedAndUnsuitablePngsAreRefused) {
  const std::string accepted = ", accepted a grey PNG without transparency";
  EXPECT_EQ(Refusal(), "accepted");
  const std::string whole = ReadText(picture());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    WriteText(picture(), whole.substr(0, size));
    const std::string what = Refusal();
    ASSERT_THAT(what, HasSubstr("file: profile.png: found " +
                                (size < 8 ? std::string("no PNG") : std::string("a PNG cut off after "))));
    ASSERT_THAT(what, HasSubstr(accepted));
  }
  // changes each byte, except for the last checksum, which no reader uses
  for (std::size_t at = 0; at + 4 < whole.size(); ++at) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x11);
    WriteText(picture(), changed);
    EXPECT_THAT(Refusal(), HasSubstr("file: profile.png: found ")) << at;
  }
  EXPECT_THAT(RefusalOf({.kind = PNG_COLOR_TYPE_RGB, .bytes = std::vector<std::uint8_t>(6)}),
              HasSubstr("file: profile.png: found a PNG in colour" + accepted));
  EXPECT_THAT(RefusalOf({.kind = PNG_COLOR_TYPE_GRAY_ALPHA, .bytes = std::vector<std::uint8_t>(4)}),
              HasSubstr("file: profile.png: found a PNG with transparency" + accepted));
  EXPECT_THAT(RefusalOf({.width = 4097, .bytes = std::vector<std::uint8_t>(2 * 4097)}),
              HasSubstr("found 4097 × 2 pixels, accepted 1 … 4096 in width and 2 … 4096 in height"));
  EXPECT_THAT(RefusalOf({.height = 4097, .bytes = std::vector<std::uint8_t>(4097)}),
              HasSubstr("found 1 × 4097 pixels"));
  EXPECT_THAT(RefusalOf({.height = 1, .bytes = {0}}), HasSubstr("found 1 × 1 pixels"));
  WriteText(picture(), "density_image: none");
  EXPECT_THAT(Refusal(), HasSubstr("found no PNG" + accepted));
  fs::remove(picture());
  EXPECT_THAT(Refusal(), HasSubstr("file: found profile.png, accepted an existing file"));
}

TEST_F(DensityImages, InvalidValuesAreRefusedWithLineKeyAndAcceptedValues) {
  struct Case {
    const char *from, *to, *expected;
  };
  for (const Case& c : {
           Case{"row_step_mm: 2", "row_step_mm: 0", "row_step_mm: found 0, accepted 0.001 … 100"},
           Case{"[0, 2.55]", "[0, 26]", "density_g_per_cm3: found 26, accepted 0 … 25"},
           Case{"[0, 2.55]", "2.55", "density_g_per_cm3: found 2.55, accepted a list of 2 numbers 0 … 25"},
           Case{"axis: [0, 0, 1]", "axis: [0, 0, 0.5]", "axis: found a length of 0.5, accepted 1"},
           Case{"    axis: [0, 0, 1]\n", "", "missing key \"axis\""},
           Case{"[5, 15]", "[15, 5]",
                "column_heights_mm: found 5 after 15, accepted the smaller height first"},
           Case{"below_g_per_cm3: 1.5", "below_g_per_cm3: 0.5",
                "below_g_per_cm3: found 0.5, accepted more than 0.5: classes ascend"},
           Case{"below_g_per_cm3: 0.5", "below_g_per_cm3: 0",
                "below_g_per_cm3: found 0, accepted more than 0: classes ascend"},
           Case{"below_g_per_cm3: 1.5, ", "", "missing key \"below_g_per_cm3\""},
           Case{"{material: cortical}", "{below_g_per_cm3: 2, material: cortical}",
                "below_g_per_cm3: found 2 in the last class, accepted none there: it takes all that is "
                "denser"},
           Case{"material: cartilage}", "material: }", "material: found nothing, accepted a text"},
           Case{"density_image:", "density_imag:",
                "unknown key \"density_imag\"; did you mean \"density_image\"?"},
       }) {
    WriteScene(Replaced(kImage, c.from, c.to));
    EXPECT_THAT(Refusal(), HasSubstr(c.expected));
  }
}

// A scene may name any material. The materials file of the cell must contain it.
TEST_F(DensityImages, AMaterialThatTheCellDoesNotHaveIsRefused) {
  const fs::path root = folder_ / "config";
  fs::copy(kConfig, root, fs::copy_options::recursive);
  const fs::path cell = root / "cells/demo.yaml", file = root / "scenes/acetabulum_density.yaml";
  WriteText(cell, Replaced(ReadText(cell), "scene: acetabulum", "scene: acetabulum_density"));
  EXPECT_TRUE(LoadCell(cell).scene.mesh_tissue.solid.image);
  WriteText(file, Replaced(ReadText(file), "{material: cortical}", "{material: cortcal}"));
  try {
    static_cast<void>(LoadCell(cell));
    ADD_FAILURE() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("accepted one with cortcal, which the scene needs"));
  }
}

// Text of a mesh [mm]: a box of 20 mm whose lower face is at z = 0.
constexpr const char* kBox =
    "v -10 -10 0\nv 10 -10 0\nv 10 10 0\nv -10 10 0\nv -10 -10 20\nv 10 -10 20\nv 10 10 20\nv -10 10 20\n"
    "f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 "
    "5 8\n";

TEST_F(DensityImages, TheMaterialInAMeshFollowsTheImage) {
  WriteText(folder_ / "box.obj", kBox);
  simulation::SceneParams params = LoadScene(scene());
  const auto solid = simulation::LoadSceneSolid(
      folder_ / "box.obj", 1.0,
      {.center_m = Vector3(0, 0, 0.020), .axis = Vector3(0, 0, 1), .radius_m = 0.002}, params);
  ASSERT_TRUE(solid) << solid.error().message;
  // density [g/cm³] at the image's pixels: 2 at the height of 5 mm and 1 at 15 mm, down to 2 mm depth; from
  // there it falls to 0.2 at 4 mm depth. The core below is cortical
  const auto at = [&](double depth_m, double height_m) {
    return params.material_names.at(solid->solid->MaterialAt({0.010 - depth_m, 0.0, height_m}));
  };
  EXPECT_EQ(at(0.001, 0.0050), "cortical");
  EXPECT_EQ(at(0.001, 0.0095), "cortical") << "1.55 g/cm^3";
  EXPECT_EQ(at(0.001, 0.0105), "cartilage") << "1.45 g/cm^3";
  EXPECT_EQ(at(0.001, 0.0150), "cartilage");
  EXPECT_EQ(at(0.0025, 0.0050), "cortical") << "1.55 g/cm^3";
  EXPECT_EQ(at(0.0026, 0.0050), "cartilage") << "1.46 g/cm^3";
  EXPECT_EQ(at(0.0032, 0.0150), "cartilage") << "0.52 g/cm^3";
  EXPECT_EQ(at(0.0033, 0.0150), "cancellous") << "0.48 g/cm^3";
  EXPECT_EQ(at(0.0039, 0.0100), "cancellous");
  EXPECT_EQ(at(0.0041, 0.0100), "cortical") << "the core";

  // after packing, every material of the image must have a share of the volume
  const auto materials = LoadMaterials(kConfig / "materials/bone.yaml");
  for (const std::string& name : params.material_names)
    params.materials.push_back(*std::ranges::find(materials, name, &simulation::Material::name));
  params.packing.lattice = {.finest_m = 1e-3, .coarser_from_m = {2e-3, 5e-3}};
  params.packing.surface_gap_m = params.packing.max_surface_gap_m = 0.3e-3;
  params.packing.samples = {.finest_m = 0.5e-3, .coarser_from_m = {2e-3, 5e-3}};
  params.points.cells = {.finest_m = 0.5e-3, .coarser_from_m = {2e-3, 5e-3}};
  const simulation::Bone bone = simulation::PackScene(*solid, params);
  std::vector<double> volume_m3(params.material_names.size());
  for (const simulation::MassPoint& point : bone.points) volume_m3.at(point.material) += point.volume_m3;
  double whole_m3 = 0.0;
  for (const double v : volume_m3) {
    EXPECT_GT(v, 0.05e-6);
    whole_m3 += v;
  }
  EXPECT_NEAR(whole_m3, 8e-6, 0.08e-6);
}

}  // namespace
}  // namespace osteon::config
