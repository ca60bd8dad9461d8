#include "io/recording/mcap_writer.h"

#include <cstdlib>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/io/temporary_folder.h"

namespace osteon::io {
namespace {

std::string Hex(const std::string& bytes) {
  std::string hex;
  for (const char byte : bytes) {
    const auto value = static_cast<unsigned char>(byte);
    hex += "0123456789abcdef"[value >> 4];
    hex += "0123456789abcdef"[value & 15];
  }
  return hex;
}

// Oracle: the bytes that the format's own TypeScript library writes for the same calls (@mcap/core 2.2.2,
// McapWriter with useChunks and useSummaryOffsets false): every record, both CRCs.
TEST(McapWriter, WritesTheBytesOfTheReferenceLibrary) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "golden.mcap";
  auto writer = McapWriter::Create(path, "osteon test");
  ASSERT_TRUE(writer) << writer.error();
  const std::uint16_t channel = writer->AddChannel("a", "T", "D");
  writer->Write(channel, 5, "xy");
  writer->Write(channel, 7, "");
  const auto size = writer->Finish();
  ASSERT_TRUE(size) << size.error();
  EXPECT_EQ(*size, 349u);
  EXPECT_EQ(Hex(test::ReadAll(path)),
            "894d434150300d0a"
            "011300000000000000000000000b0000006f7374656f6e2074657374"
            "031800000000000000010001000000540800000070726f746f6275660100000044"
            "0419000000000000000000010001000000610800000070726f746f62756600000000"
            "0518000000000000000000000000000500000000000000050000000000000078"
            "79"
            "051600000000000000000001000000070000000000000007000000000000"
            "00"
            "0f040000000000000051bfbbe0"
            "031800000000000000010001000000540800000070726f746f6275660100000044"
            "0419000000000000000000010001000000610800000070726f746f62756600000000"
            "0b380000000000000002000000000000000100010000000000000000000000000000000500000000000000"
            "07000000000000000a00000000000200000000000000"
            "021400000000000000b4000000000000000000000000000000fd4fc9eb"
            "894d434150300d0a");
}

TEST(McapWriter, NamesThePathThatItCannotCreate) {
  const auto writer = McapWriter::Create("/nowhere/at/all.mcap", "osteon test");
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error(), "/nowhere/at/all.mcap: cannot create the recording: No such file or directory");
}

TEST(McapWriter, NamesThePathOnAFullDisk) {
  auto writer = McapWriter::Create("/dev/full", "osteon test");  // every write fails with ENOSPC
  ASSERT_TRUE(writer);
  writer->Write(writer->AddChannel("a", "T", "D"), 5, "xy");
  writer->Flush();
  EXPECT_TRUE(writer->failed());
  const auto size = writer->Finish();
  ASSERT_FALSE(size);
  EXPECT_EQ(size.error(), "/dev/full: cannot write the recording: No space left on device");
}

}  // namespace
}  // namespace osteon::io
