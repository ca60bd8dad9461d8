#include "base/write_text.h"

#include "base/output_file.h"

namespace osteon::base {

tl::expected<void, std::string> WriteText(const std::filesystem::path& path, const std::string& text) {
  const auto refuse = [&](const simulation::FileError& error) {
    return tl::make_unexpected(path.string() + ": can't be written: " + error.found);
  };
  auto file = simulation::OutputFile::Create(path);
  if (!file) return refuse(file.error());
  file->Write(text);
  if (const auto written = file->Commit(); !written) return refuse(written.error());
  return {};
}

}  // namespace osteon::base
