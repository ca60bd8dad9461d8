#include "simulation/packing/packing_export.h"

#include <sstream>

#include <gmock/gmock.h>

#include "tests/simulation/packing/packing_file_fixture.h"

// Tests of the export of a packing to PLY and CSV files.

namespace osteon::simulation {
namespace {

using io::test::ReadAll;
using testing::HasSubstr;
using namespace test;

using PackingExportTest = PackingFileTest;

TEST_F(PackingExportTest, PlyHoldsTheBallsInMillimetres) {
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

TEST_F(PackingExportTest, CsvHoldsTheBallsInMillimetres) {
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
    // tolerance: float32 of up to a metre, in millimetres
    EXPECT_LT((Vector3(x, y, z) - Vector3(ball.center_m) * 1e3).norm(), 1e-4);
    EXPECT_NEAR(r, ball.radius_m * 1e3, 1e-6);
  }
  EXPECT_EQ(count, bone.balls.size());
}

TEST_F(PackingExportTest, AnExportToAFullDiskIsReported) {
  for (const auto& written :
       {WritePly("/dev/full", SomeBone().balls), WriteCsv("/dev/full", SomeBone().balls)}) {
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().Text(), HasSubstr("No space left on device"));
  }
}

}  // namespace
}  // namespace osteon::simulation
