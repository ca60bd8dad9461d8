#include "config/reading/sections/density_image.h"
#include "tests/fuzz/targets/file_claims.h"

// Fuzz target: a density image. The input is the PNG file.

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  static const fuzz::FuzzFile scratch("fuzz.png");
  scratch.Write(fuzz::Text({data, size}));
  const auto image = config::ReadGreyPng(scratch.path());
  if (!image) {
    fuzz::Claim(image.error().starts_with("found ") && image.error().find("accepted") != std::string::npos,
                "an error says what was found and what is accepted");
    return 0;
  }
  fuzz::Claim(image->rows >= 2 && image->rows <= 4096 && image->columns >= 1 && image->columns <= 4096,
              "a picture has the sizes that are accepted");
  fuzz::Claim(
      image->level.size() == static_cast<std::size_t>(image->rows) * static_cast<std::size_t>(image->columns),
      "and a sample for each place");
  for (const float level : image->level)
    fuzz::Claim(level >= 0.0f && level <= 1.0f, "a sample is between black and white");
  return 0;
}
