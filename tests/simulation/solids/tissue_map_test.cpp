#include "simulation/solids/tissue_map.h"

#include <functional>

#include <gmock/gmock.h>

#include "simulation/solids/mesh_solid.h"
#include "tests/simulation/bone/cup_bone.h"
#include "tests/simulation/mesh/mesh_shapes.h"

namespace osteon::simulation {
namespace {

using testing::HasSubstr;

/// Image of a bone with a dense rim and a soft core: 1800 kg/m³ at the surface, 600 at a depth of 2 mm, 200
/// at 4 mm. The second column is half as dense.
DensityImage GradedImage() {
  return {.rows = 3,
          .columns = 2,
          .row_step_m = 0.002,
          .density_kg_per_m3 = {1800, 900, 600, 300, 200, 100},
          .axis = Vector3(0, 0, 1),
          .first_column_m = -0.01,
          .last_column_m = 0.01,
          .classes = {{.below_kg_per_m3 = 500, .material = 3},
                      {.below_kg_per_m3 = 1000, .material = 2},
                      {.material = 1}}};
}

TEST(DensityImage, IsBilinearBetweenSamplesAndConstantBeyondThem) {
  const DensityImage image = GradedImage();
  EXPECT_DOUBLE_EQ(image.DensityAt(0.0, -0.01), 1800);
  EXPECT_DOUBLE_EQ(image.DensityAt(0.0, 0.01), 900);
  EXPECT_DOUBLE_EQ(image.DensityAt(0.001, -0.01), 1200);
  EXPECT_DOUBLE_EQ(image.DensityAt(0.001, 0.0), 0.25 * (1800 + 900 + 600 + 300));
  EXPECT_DOUBLE_EQ(image.DensityAt(0.003, -0.005),
                   0.5 * (0.75 * 600 + 0.25 * 300) + 0.5 * (0.75 * 200 + 0.25 * 100));
  EXPECT_DOUBLE_EQ(image.DensityAt(0.004, 0.01), 100);
  // beyond the columns and above the surface: the nearest sample
  EXPECT_DOUBLE_EQ(image.DensityAt(0.0, -0.5), 1800);
  EXPECT_DOUBLE_EQ(image.DensityAt(0.002, 0.5), 300);
  EXPECT_DOUBLE_EQ(image.DensityAt(-0.001, 0.0), 1350);
}

TEST(DensityImage, OneColumnIsTheDensityEverywhere) {
  DensityImage image = GradedImage();
  image.columns = 1;
  image.density_kg_per_m3 = {1800, 600, 200};
  for (const double height_m : {-1.0, 0.0, 0.3}) EXPECT_DOUBLE_EQ(image.DensityAt(0.001, height_m), 1200);
}

TEST(DensityImage, MaterialChangesWhereTheDensityCrossesAClassLimit) {
  const DensityImage image = GradedImage();
  // first column: 1800 → 600 over 2 mm crosses 1000 at 1.3333 mm, 600 → 200 crosses 500 at 2.5 mm
  EXPECT_EQ(image.MaterialAt(0.00133, -0.01), 1);
  EXPECT_EQ(image.MaterialAt(0.00134, -0.01), 2);
  EXPECT_EQ(image.MaterialAt(0.00249, -0.01), 2);
  EXPECT_EQ(image.MaterialAt(0.00251, -0.01), 3);
  DensityImage capped = image;
  capped.classes = {{.below_kg_per_m3 = 500, .material = 3}, {.below_kg_per_m3 = 1000, .material = 2}};
  EXPECT_EQ(capped.MaterialAt(0.0, -0.01), 2);  // the last class includes higher densities
}

TEST(TissueMap, AGradedBoneHasADenseRimAndASoftCore) {
  TissueMap map;
  map.shells[0].image = GradedImage();
  map.shells[0].core = 4;
  const MeshSolid solid(MakeBox({-0.02, -0.02, -0.02}, {0.02, 0.02, 0.02}), map);
  // points below the face x = 20 mm, at the heights of the dense column (z = -10 mm) and the soft one (10 mm)
  EXPECT_EQ(solid.MaterialAt({0.0195, 0, -0.01}), 1);
  EXPECT_EQ(solid.MaterialAt({0.0195, 0, 0.01}), 2);
  EXPECT_EQ(solid.MaterialAt({0.0180, 0, -0.01}), 2);
  EXPECT_EQ(solid.MaterialAt({0.0180, 0, 0.01}), 3);
  EXPECT_EQ(solid.MaterialAt({0.0161, 0, -0.01}), 3);
  EXPECT_EQ(solid.MaterialAt({0.0159, 0, -0.01}), 4);  // deeper than the image
}

TEST(TissueMap, LayersReplaceTheOutermostPartOfTheImage) {
  ShellTissue tissue{
      .layers = {{.material = 5, .thickness_m = 0.001}, {.material = 6, .thickness_m = 0.0005}},
      .core = 4,
      .image = GradedImage()};
  const Vector3 p(0, 0, -0.01);
  EXPECT_EQ(tissue.MaterialAt(0.0009, p), 5);
  EXPECT_EQ(tissue.MaterialAt(0.0014, p), 6);
  EXPECT_EQ(tissue.MaterialAt(0.0016, p), 2);  // the image's depth counts from the surface
  EXPECT_EQ(tissue.MaterialAt(0.0041, p), 4);
  EXPECT_FALSE(tissue.IsUniform());
  EXPECT_TRUE((ShellTissue{.layers = {}, .core = 2, .image = {}}).IsUniform());
}

TEST(TissueMap, RegionsBeyondTheListedTissuesTakeTheLastTissue) {
  LoadedMesh loaded;
  loaded.mesh = MakeBox({0, 0, 0}, {0.03, 0.01, 0.01});
  for (const double x : {0.002, 0.012, 0.022})
    loaded.regions.push_back(
        {.name = "", .mesh = MakeBox({x, 0.002, 0.002}, {x + 0.006, 0.008, 0.008}), .parent = {}});
  TissueMap map;
  map.shells = {{.layers = {}, .core = 1, .image = {}}, {.layers = {}, .core = 2, .image = {}}};
  const MeshSolid solid(loaded, map);
  EXPECT_EQ(solid.MaterialAt({0.001, 0.005, 0.005}), 1);
  for (const double x : {0.005, 0.015, 0.025}) EXPECT_EQ(solid.MaterialAt({x, 0.005, 0.005}), 2);
}

TEST(TissueMap, RefusalNamesTheWrongEntryAndWhatIsAccepted) {
  const auto refusal = [](const std::function<void(TissueMap&)>& change) -> std::string {
    TissueMap map = CupBoneTissue({}, {});
    map.shells[0].image = GradedImage();
    change(map);
    try {
      CheckTissueMap(map, 4);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  using Map = TissueMap&;
  EXPECT_EQ(refusal([](Map) {}), "");
  EXPECT_EQ(refusal([](Map m) { m.shells.clear(); }), "tissue: found no shells, accepted one and more");
  EXPECT_EQ(refusal([](Map m) { m.shells[0].layers[0].thickness_m = -0.001; }),
            "tissue: shell 0: layer 0: thickness: found -1 mm, accepted 0 … 100 mm");
  EXPECT_EQ(refusal([](Map m) { m.shells[0].layers[0].material = 4; }),
            "tissue: shell 0: layer 0: found material 4, accepted 0 … 3");
  EXPECT_EQ(refusal([](Map m) { m.shells[0].core = 9; }),
            "tissue: shell 0: core: found material 9, accepted 0 … 3");
  EXPECT_THAT(refusal([](Map m) { m.shells[0].image->rows = 1; }), HasSubstr("found 1 × 2 samples"));
  EXPECT_THAT(refusal([](Map m) { m.shells[0].image->density_kg_per_m3.pop_back(); }),
              HasSubstr("found 5 densities, accepted 3 × 2 = 6"));
  EXPECT_THAT(refusal([](Map m) { m.shells[0].image->density_kg_per_m3[3] = -1; }),
              HasSubstr("row 1, column 1: found -1 kg/m^3"));
  EXPECT_THAT(refusal([](Map m) { m.shells[0].image->row_step_m = 0; }), HasSubstr("row step: found 0 mm"));
  EXPECT_THAT(refusal([](Map m) { m.shells[0].image->axis = Vector3(0, 0, 2); }),
              HasSubstr("accepted a unit vector"));
  EXPECT_THAT(refusal([](Map m) { m.shells[0].image->last_column_m = -0.01; }),
              HasSubstr("accepted ascending heights"));
  EXPECT_THAT(refusal([](Map m) { m.shells[0].image->classes.clear(); }),
              HasSubstr("found no density classes"));
  EXPECT_THAT(refusal([](Map m) { m.shells[0].image->classes[1].below_kg_per_m3 = 500; }),
              HasSubstr("class 1: found below 500 kg/m^3, accepted more than 500"));
  EXPECT_THAT(refusal([](Map m) { m.shells[0].image->classes[2].material = 7; }),
              HasSubstr("class 2: found material 7"));
  EXPECT_THAT(refusal([](Map m) { m.lining->lining_radii = 3; }),
              HasSubstr("lining_radii: found 3, accepted 1 … 2"));
  EXPECT_THAT(refusal([](Map m) { m.lining->layers[1].material = 8; }), HasSubstr("tissue: lining: layer 1"));
}

}  // namespace
}  // namespace osteon::simulation
