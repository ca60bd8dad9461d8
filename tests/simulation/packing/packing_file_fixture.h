#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "simulation/packing/packing_file.h"
#include "tests/io/temporary_folder.h"
#include "tests/simulation/packing/packing_samples.h"

namespace osteon::simulation::test {

/// Order of the sections of a file that has all of them.
inline constexpr std::size_t kBallSection = 0, kPointSection = 1, kPointMaterialSection = 2,
                             kMaterialSection = 3, kSiteSection = 4, kProvenanceSection = 5;

/// A temporary folder with files: valid ones, and ones that must be refused.
class PackingFileTest : public testing::Test {
 protected:
  std::filesystem::path Path(const std::string& name = "bone.osp") const { return folder_.path() / name; }

  /// Saves the bone; @returns the file's bytes.
  std::string Saved(const Bone& bone, const PackingProvenance& provenance = SomeProvenance()) {
    const auto written = WritePackingFile(Path(), bone, provenance);
    EXPECT_TRUE(written) << written.error().Text();
    return io::test::ReadAll(Path());
  }

  /// The error of opening these bytes, which must be refused.
  FileError Refusal(const std::string& bytes) {
    io::test::WriteAll(Path("bad.osp"), bytes);
    const auto file = PackingFile::Open(Path("bad.osp"));
    if (file) ADD_FAILURE() << "the file was accepted";
    return file ? FileError{} : file.error();
  }

  /// The error of writing this bone, which must be refused without leaving a file.
  FileError WriteRefusal(const Bone& bone, const PackingProvenance& provenance = SomeProvenance()) {
    const auto written = WritePackingFile(Path("refused.osp"), bone, provenance);
    if (written) ADD_FAILURE() << "the bone was accepted";
    EXPECT_FALSE(std::filesystem::exists(Path("refused.osp")));
    return written ? FileError{} : written.error();
  }

  io::test::TemporaryFolder folder_;
};

}  // namespace osteon::simulation::test
