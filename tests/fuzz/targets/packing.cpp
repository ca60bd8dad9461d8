#include <cmath>
#include <limits>

#include "tests/fuzz/targets/file_claims.h"
#include "tests/simulation/packing/packing_samples.h"

// Fuzz target: a packing file. Bit 0 of the input's byte 0 says whether the checksums are corrected first, as
// an attacker would do. The rest of the input is the file.

namespace osteon::fuzz {
namespace {

// Claims that an engine can use a packing that was accepted.
void ClaimUsable(const simulation::Bone& bone) {
  Claim(!bone.balls.empty(), "a packing has balls");
  for (const simulation::Ball& ball : bone.balls)
    Claim(Vector3(ball.center_m).allFinite() && ball.radius_m > 0.0 && ball.radius_m <= 0.512,
          "a ball has a place and a size");
  for (const simulation::MassPoint& point : bone.points)
    Claim(Vector3(point.p_m).allFinite() && point.volume_m3 > 0.0 && std::isfinite(point.volume_m3) &&
              point.material < bone.materials.size(),
          "a mass point has a place, a volume and a material of the list");
  simulation::CheckMaterials(bone.materials);
  if (bone.site.radius_m > 0.0)
    Claim(std::abs(Vector3(bone.site.axis).norm() - 1.0) <= 1e-6, "a site has an axis");
}

// Claims that an accepted packing can be saved, and that saving it a second time gives the same file.
void ClaimSavesToItself(const simulation::PackingFile& file, const simulation::Bone& bone) {
  static const FuzzFile saved("saved.osp");
  if (!simulation::WritePackingFile(saved.path(), bone, file.provenance()))
    return;  // the balls are so far apart that their centre is not finite
  const std::string first = io::test::ReadAll(saved.path());
  const auto again = simulation::PackingFile::Open(saved.path(), 1);
  Claim(again.has_value(), "what was saved is accepted");
  Claim(again->provenance() == file.provenance() && again->name() == file.name(), "with its provenance");
  Claim(simulation::WritePackingFile(saved.path(), again->ToBone(), again->provenance()).has_value(),
        "a loaded packing can be saved");
  Claim(io::test::ReadAll(saved.path()) == first, "a loaded packing saves to the bytes it came from");
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  static const fuzz::FuzzFile scratch("fuzz.osp");
  fuzz::Input in(data, size);
  const bool seal = (in.Byte() & 1u) != 0;
  std::string bytes = fuzz::Text(in.Rest());
  if (seal) simulation::test::SealIfPossible(bytes);
  scratch.Write(bytes);
  const auto file = simulation::PackingFile::Open(scratch.path(), 1);
  if (!file) {
    fuzz::Claim(!file.error().found.empty() && !file.error().accepted.empty(), "an error has a text");
    if (!bytes.empty()) fuzz::ClaimNamesByte(file.error().Text(), scratch.path(), bytes.size());
    return 0;
  }
  const simulation::Bone bone = file->ToBone();
  fuzz::ClaimUsable(bone);
  fuzz::ClaimSavesToItself(*file, bone);
  return 0;
}
