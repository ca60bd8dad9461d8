#include "simulation/packing/packing_text.h"
#include "tests/fuzz/targets/file_claims.h"

// Fuzz target: the two texts in a packing file. Bit 0 of the input's byte 0 selects the materials (1) or the
// provenance (0); the rest is the text. A text that was read must be writable, and reading it again must give
// the same result.

namespace osteon::fuzz {
namespace {

void ClaimError(const simulation::TextError& error, std::string_view text) {
  Claim(error.byte <= text.size(), "an error names a byte of the text");
  Claim(!error.found.empty() && !error.accepted.empty(), "an error has a text");
}

void ClaimMaterials(std::string_view text) {
  const auto materials = simulation::MaterialsFromText(text);
  if (!materials) return ClaimError(materials.error(), text);
  simulation::CheckMaterials(*materials);
  const auto again = simulation::MaterialsToText(*materials);
  Claim(again.has_value(), "materials that were read can be written");
  const auto back = simulation::MaterialsFromText(*again);
  Claim(back.has_value(), "and read again");
  Claim(simulation::MaterialsToText(*back).value() == *again, "and are then the same");
}

void ClaimProvenance(std::string_view text) {
  const auto read = simulation::ProvenanceFromText(text);
  if (!read) return ClaimError(read.error(), text);
  const auto again = simulation::ProvenanceToText(*read);
  Claim(again.has_value(), "a provenance that was read can be written");
  const auto back = simulation::ProvenanceFromText(*again);
  Claim(back && back->name == read->name && back->provenance == read->provenance, "and is then the same");
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  fuzz::Input in(data, size);
  const bool materials = (in.Byte() & 1u) != 0;
  const std::string text = fuzz::Text(in.Rest());
  materials ? fuzz::ClaimMaterials(text) : fuzz::ClaimProvenance(text);
  return 0;
}
