#include <zlib.h>

#include <cstring>

#include "simulation/engine/reference_engine.h"
#include "simulation/files/carved_file.h"
#include "tests/fuzz/targets/file_claims.h"
#include "tests/simulation/files/carved_samples.h"

// Fuzz target: the file with the carved state of a small bone. Bit 0 of the input's byte 0 says whether size
// and checksums are corrected before the file is read. The rest of the input is the file.

namespace osteon::fuzz {
namespace {

// Size of the header and offsets of its fields [byte].
constexpr std::size_t kHeader = 392, kPayloadCrcAt = 384, kHeaderCrcAt = 388;

// Corrects the file's size and checksums in its header.
void SealCarvedFile(std::string& bytes) {
  if (bytes.size() < kHeader) return;
  const std::uint64_t size = bytes.size();
  std::memcpy(bytes.data() + 16, &size, sizeof(size));
  const auto put = [&](std::size_t at, std::size_t from, std::size_t to) {
    const auto crc = static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()) + from, to - from));
    std::memcpy(bytes.data() + at, &crc, sizeof(crc));
  };
  put(kPayloadCrcAt, kHeader, bytes.size());
  put(kHeaderCrcAt, 0, kHeaderCrcAt);
}

// Claims that an engine of this bone either resumes from the state or refuses it. A refusal is legitimate if
// the state belongs to another tool or to other SplitParams, because the file records neither.
void ClaimResumes(const simulation::CarvedState& state) {
  using namespace simulation::test;
  simulation::ReferenceEngine engine(CarvedBone(), CarvedTool(), Pose::Identity(), CarvedParams());
  try {
    engine.Restore(state);
  } catch (const std::invalid_argument& error) {
    return Claim(std::string_view(error.what()).starts_with("carved state: "), "a refusal says of what");
  }
  for (int i = 0; i < 3; ++i) {
    const simulation::ContactModel model = engine.Step(CarvedFrame(4e-3 - 0.2e-3 * i));
    Claim(Pose(model.X_WP).matrix().allFinite(), "the proxy has a place");
    Claim(Vector3(model.F_T_W.f).allFinite(), "and the wrench is finite");
  }
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  static const fuzz::FuzzFile scratch("fuzz.osc"), saved("saved.osc");
  static const simulation::Bone bone = simulation::test::CarvedBone();
  fuzz::Input in(data, size);
  const bool seal = (in.Byte() & 1u) != 0;
  std::string bytes = fuzz::Text(in.Rest());
  if (seal) fuzz::SealCarvedFile(bytes);
  scratch.Write(bytes);
  const auto state = simulation::ReadCarvedState(scratch.path(), bone);
  if (!state) {
    if (!bytes.empty()) fuzz::ClaimNamesByte(state.error().Text(), scratch.path(), bytes.size());
    return 0;
  }
  fuzz::Claim(simulation::WriteCarvedState(saved.path(), *state, bone).has_value(),
              "a state that was read can be saved");
  const auto again = simulation::ReadCarvedState(saved.path(), bone);
  fuzz::Claim(again && simulation::HashState(*again) == simulation::HashState(*state), "and is the same");
  fuzz::ClaimResumes(*state);
  return 0;
}
