#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/plugin/plugin_objects.h"
#include "tests/temporary_path.h"

// The warning that a program of the C interface gets for a mesh that does not bound a solid.

namespace osteon::plugin {
namespace {

// A box of 12 × 12 × 4 mm around the origin; without its last triangle it is open.
std::string WriteBox(const std::string& name, bool open) {
  const std::filesystem::path file = TemporaryPath(name);
  std::ofstream out(file);
  for (const int z : {-2, 2})
    for (const int y : {-6, 6})
      for (const int x : {-6, 6}) out << "v " << x << ' ' << y << ' ' << z << '\n';
  out << "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 "
         "8\n";
  if (!open) out << "f 2 8 6\n";
  return file.string();
}

// A bone of the mesh, with the site on its upper face.
Owned<OsteonBone> BoneOfMesh(const std::string& file) {
  OsteonBoneParams params;
  osteon_bone_params_default(&params);
  params.config_folder = ConfigFolder().c_str();
  params.scene = "thin_plate";
  params.mesh_file = file.c_str();
  params.site_center_m[2] = 0.002;
  params.site_axis[2] = 1.0;
  params.site_radius_m = 0.0015;
  OsteonBone* bone = nullptr;
  EXPECT_OK(osteon_bone_create(OSTEON_ABI, &params, &bone));
  return Owned<OsteonBone>(bone);
}

// A bone made from an open mesh differs from the file. osteon_bone_warning says so, and so does the log of a
// session with this bone.
TEST(OsteonLibrary, WarnsOfAnOpenMeshByCallAndByLog) {
  EXPECT_STREQ(osteon_bone_warning(nullptr), "");
  const auto whole = BoneOfMesh(WriteBox("whole.obj", false)), open = BoneOfMesh(WriteBox("open.obj", true));
  EXPECT_STREQ(osteon_bone_warning(whole.get()), "");
  const std::string text = osteon_bone_warning(open.get());
  EXPECT_NE(text.find("open.obj"), std::string::npos) << text;
  EXPECT_NE(text.find("found 3 open edges"), std::string::npos) << text;
  EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  const auto tool = BallTool();
  const auto session = MakeSession(open.get(), tool.get(), Lockstep(false));
  std::vector<std::string> warnings;
  const OsteonLogCallback keep = [](void* user, std::uint32_t level, const char* line) {
    if (level == OSTEON_LOG_WARNING) static_cast<std::vector<std::string>*>(user)->emplace_back(line);
  };
  ASSERT_OK(osteon_session_set_log(session.get(), keep, &warnings));
  EXPECT_EQ(warnings, std::vector<std::string>{text});
}

}  // namespace
}  // namespace osteon::plugin
