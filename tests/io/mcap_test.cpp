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
// McapWriter with chunkSize 100 and useSummaryOffsets false): two chunks, three message indexes, the summary,
// every CRC.
TEST(McapWriter, WritesTheBytesOfTheReferenceLibrary) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "golden.mcap";
  auto writer = McapWriter::Create(path, "osteon test", 100);
  ASSERT_TRUE(writer) << writer.error();
  const std::uint16_t a = writer->AddChannel("a", "T", "Da");
  const std::uint16_t b = writer->AddChannel("b", "T", "Db");
  writer->Write(a, 9, "xy");
  writer->Write(a, 7, "");
  writer->Write(b, 8, "z");
  const auto size = writer->Finish();
  ASSERT_TRUE(size) << size.error();
  EXPECT_EQ(*size, 896u);
  EXPECT_EQ(
      Hex(test::ReadAll(path)),
      "894d434150300d0a"
      "011300000000000000000000000b0000006f7374656f6e2074657374"
      "068d00000000000000090000000000000009000000000000006500000000000000a8acaed00000000065000000000000000319"
      "00000000000000010001000000540800000070726f746f62756602000000446104190000000000000000000100010000006108"
      "00000070726f746f62756600000000051800000000000000000000000000090000000000000009000000000000007879"
      "07160000000000000000001000000009000000000000004400000000000000"
      "06ab00000000000000070000000000000008000000000000008300000000000000050fb31c0000000083000000000000000516"
      "000000000000000000010000000700000000000000070000000000000003190000000000000002000100000054080000007072"
      "6f746f6275660200000044620419000000000000000100020001000000620800000070726f746f627566000000000517000000"
      "00000000010000000000080000000000000008000000000000007a"
      "07160000000000000000001000000007000000000000000000000000000000"
      "07160000000000000001001000000008000000000000006300000000000000"
      "0f04000000000000009f8a62dc"
      "031900000000000000010001000000540800000070726f746f627566020000004461"
      "031900000000000000020001000000540800000070726f746f627566020000004462"
      "0419000000000000000000010001000000610800000070726f746f62756600000000"
      "0419000000000000000100020001000000620800000070726f746f62756600000000"
      "0b4200000000000000030000000000000002000200000000000000000000000200000007000000000000000900000000000000"
      "140000000000020000000000000001000100000000000000"
      "084a0000000000000009000000000000000900000000000000240000000000000096000000000000000a0000000000ba000000"
      "000000001f000000000000000000000065000000000000006500000000000000"
      "08540000000000000007000000000000000800000000000000d900000000000000b4000000000000001400000000008d010000"
      "000000000100ac010000000000003e000000000000000000000083000000000000008300000000000000"
      "021400000000000000d8010000000000000000000000000000cc752bb6"
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
