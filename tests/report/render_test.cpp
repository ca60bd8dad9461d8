#include "report/render.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <png.h>

#include "report/bone_view.h"
#include "report_synthetic.h"
#include "tests/temporary_path.h"

namespace osteon::report {
namespace {

/// A sphere of flat triangles, with steps of π / parts; the largest gap between triangles and sphere is
/// r (1 - cos(π / parts)).
BoneMesh SphereMesh(const Vector3& center_m, double radius_m, int parts) {
  BoneMesh mesh;
  for (int i = 0; i <= parts; ++i)
    for (int j = 0; j < 2 * parts; ++j) {
      const double a = M_PI * i / parts, b = M_PI * j / parts;
      const Vector3 n(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
      mesh.vertices_m.emplace_back((center_m + radius_m * n).cast<float>());
      mesh.normals.emplace_back(n.cast<float>());
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(2 * parts * i + j % (2 * parts)); };
  for (int i = 0; i < parts; ++i)
    for (int j = 0; j < 2 * parts; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

// Oracle: the ray s d through a pixel's centre meets the sphere |s d - c| = r at the smaller root s of this
// quadratic equation.
TEST(Render, DepthAndNormalOfASphereAreAnalytic) {
  const Camera camera = LookAt({0.02, -0.3, 0.25}, {0, 0, 0}, Vector3::UnitZ(), 900.0, 240, 180);
  const Vector3 center(0.01, 0.005, -0.008);
  const double radius = 0.03;
  std::vector<Eigen::Vector3f> normals;
  const DepthBuffer depth = RenderDepth(SphereMesh(center, radius, 400), camera, &normals);
  int seen = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Vector3 ray = camera.Ray(x + 0.5, y + 0.5), d = ray.normalized(), c = center - camera.eye;
      const double from_axis = (c - c.dot(d) * d).norm();
      if (std::abs(from_axis - radius) > 1e-3 * radius)  // at the outline flat triangles may miss the pixel
        ASSERT_EQ(depth.Seen(x, y), from_axis < radius) << x << " " << y;
      if (!depth.Seen(x, y) || from_axis > 0.95 * radius) continue;
      ++seen;
      const double along = c.dot(d) - std::sqrt(radius * radius - from_axis * from_axis);
      ASSERT_NEAR(depth.At(x, y), along / ray.norm(), 4e-6)
          << "gap to the sphere of 1e-6, a few times that at a slant";
      const Vector3 n = (camera.eye + along * d - center).normalized();
      EXPECT_LT((normals[static_cast<std::size_t>(y * camera.width + x)].cast<double>() - n).norm(), 1e-3);
    }
  EXPECT_GT(seen, 9'000);
}

TEST(Render, ProjectAndRayAreInverse) {
  const Camera camera = LookAt({0.1, -0.3, 0.25}, {0.01, 0, 0}, Vector3::UnitZ(), 700.0, 300, 200);
  const Vector3 p(0.013, -0.021, 0.004), at = camera.Project(p);
  EXPECT_TRUE((camera.eye + at.z() * camera.Ray(at.x(), at.y())).isApprox(p, 1e-12));
}

TEST(Render, NearerSurfaceHidesTheFarther) {
  const Camera camera = LookAt({0, 0, 0.5}, {0, 0, 0}, Vector3::UnitY(), 500.0, 101, 101);
  BoneMesh both = SphereMesh({0, 0, -0.1}, 0.05, 60);
  const BoneMesh nearer = SphereMesh({0, 0, 0}, 0.02, 60);
  const auto first = static_cast<std::uint32_t>(both.vertices_m.size());
  both.vertices_m.insert(both.vertices_m.end(), nearer.vertices_m.begin(), nearer.vertices_m.end());
  for (const auto& t : nearer.triangles) both.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  EXPECT_NEAR(RenderDepth(both, camera).At(50, 50), 0.48, 1e-4);
}

TEST(Render, TrianglesBehindTheCameraOrNotFiniteAreLeftOut) {
  const Camera camera = LookAt({0, 0, 0.5}, {0, 0, 0}, Vector3::UnitY(), 500.0, 51, 51);
  for (const Vector3& center : {Vector3(0, 0, 0.9), Vector3(0, 0, 0.49), Vector3(NAN, 0, 0)})
    for (const float z : RenderDepth(SphereMesh(center, 0.05, 20), camera).depth_m)
      if (z != DepthBuffer::kNothing) {
        ASSERT_GT(z, 0.0F);
      }
  const BoneMesh behind = SphereMesh({0, 0, 0.9}, 0.05, 20);
  for (const float z : RenderDepth(behind, camera).depth_m) EXPECT_EQ(z, DepthBuffer::kNothing);
}

TEST(Render, TheWholeBlockIsInThePictureAndColouredByMaterial) {
  const SyntheticRun run = MakeSyntheticRun({.tilt_rad = 0.17});
  const MaterialMap materials(run.bone.points);
  const Camera camera = CupCamera(run.bone);
  const std::vector<Pose> path = PathOf(run);
  const simulation::ToolPath tool{.tool = &run.tool, .X_GP = path};
  const BoneMeshes meshes =
      MeshBone({.bone = run.bone, .materials = materials, .paths = {&tool, 1}, .max_quads = 1'000'000});
  const Image before = RenderBone(run.bone, meshes.before, materials, camera);
  const Image after = RenderBone(run.bone, meshes.after, materials, camera);
  ASSERT_EQ(before.rgb.size(), 3u * 860u * 700u);
  std::size_t covered = 0, border = 0;
  double warm_before = 0.0, warm_after = 0.0;  // red minus blue, summed over the bone's pixels
  for (int y = 0; y < before.height; ++y)
    for (int x = 0; x < before.width; ++x) {
      const std::uint8_t* b = before.rgb.data() + 3 * (y * before.width + x);
      const std::uint8_t* a = after.rgb.data() + 3 * (y * before.width + x);
      const bool bone = b[0] != 255 || b[1] != 255 || b[2] != 255;
      covered += bone ? 1 : 0;
      if (x == 0 || y == 0 || x + 1 == before.width || y + 1 == before.height) border += bone ? 1 : 0;
      warm_before += bone ? b[0] - b[2] : 0;
      warm_after += bone ? a[0] - a[2] : 0;
    }
  EXPECT_GT(covered, 860u * 700u / 3);
  EXPECT_EQ(border, 0u) << "nothing of the block is cut off";
  EXPECT_GT(warm_after, 1.05 * warm_before) << "the cut lays reddish bone bare below the bluish cartilage";
}

TEST(Png, WrittenPixelsAreReadBackByLibpng) {
  Image image{.width = 7, .height = 3};
  for (int i = 0; i < 63; ++i) image.rgb.push_back(static_cast<std::uint8_t>(i * 4));
  const auto file = TemporaryPath("picture.png");
  ASSERT_TRUE(WritePng(image, file).has_value());
  png_image read{};
  read.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&read, file.c_str()), 0);
  read.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(read));
  ASSERT_NE(png_image_finish_read(&read, nullptr, rgb.data(), 0, nullptr), 0);
  EXPECT_EQ(rgb, image.rgb);
  EXPECT_FALSE(EncodePng({.width = 2, .height = 2, .rgb = {1, 2, 3}}).has_value());
  EXPECT_FALSE(WritePng(image, "/no/such/folder/p.png").has_value());
}

TEST(Base64, EncodesTheTestVectorsOfRfc4648) {
  const auto of = [](std::string_view text) { return Base64({text.begin(), text.end()}); };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foo"), "Zm9v");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace osteon::report
