#include "io/recording/mcap_writer.h"

#include <cstdlib>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "io/recording/mcap_bytes.h"
#include "io/recording/mcap_reader.h"
#include "tests/io/temporary_folder.h"

// The writer and reader of MCAP files, against the bytes of other programs.

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
  auto writer = McapWriter::Create(path, "osteon test", {.chunk_bytes = 100, .compress = false});
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
      "894d434150300d0a011300000000000000000000000b0000006f7374656f6e2074657374068d00000000000000090000000000"
      "000009000000000000006500000000000000a8acaed00000000065000000000000000319000000000000000100010000005408"
      "00000070726f746f6275660200000044610419000000000000000000010001000000610800000070726f746f62756600000000"
      "051800000000000000000000000000090000000000000009000000000000007879071600000000000000000010000000090000"
      "0000000000440000000000000006ab00000000000000070000000000000008000000000000008300000000000000050fb31c00"
      "000000830000000000000005160000000000000000000100000007000000000000000700000000000000031900000000000000"
      "020001000000540800000070726f746f6275660200000044620419000000000000000100020001000000620800000070726f74"
      "6f62756600000000051700000000000000010000000000080000000000000008000000000000007a0716000000000000000000"
      "100000000700000000000000000000000000000007160000000000000001001000000008000000000000006300000000000000"
      "0f04000000000000009f8a62dc031900000000000000010001000000540800000070726f746f62756602000000446103190000"
      "0000000000020001000000540800000070726f746f627566020000004462041900000000000000000001000100000061080000"
      "0070726f746f627566000000000419000000000000000100020001000000620800000070726f746f627566000000000b420000"
      "000000000003000000000000000200020000000000000000000000020000000700000000000000090000000000000014000000"
      "0000020000000000000001000100000000000000084a0000000000000009000000000000000900000000000000240000000000"
      "000096000000000000000a0000000000ba000000000000001f0000000000000000000000650000000000000065000000000000"
      "0008540000000000000007000000000000000800000000000000d900000000000000b4000000000000001400000000008d0100"
      "00000000000100ac010000000000003e0000000000000000000000830000000000000083000000000000000214000000000000"
      "00d8010000000000000000000000000000cc752bb6894d434150300d0a");
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

// The files below are as other programs write them, built record by record according to
// https://mcap.dev/spec. The compressed bytes come from the programs zstd 1.5.4 (level 3) and lz4 1.9.4
// (level 9, with content checksum), for MadeRecords().

// The bytes of a hexadecimal text.
std::string FromHex(const std::string& hex) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return bytes;
}

std::string Record(mcap::Opcode opcode, const std::string& content) {
  std::string record;
  mcap::AppendRecord(record, opcode, content);
  return record;
}

/// A channel without a schema, and three messages on this channel; the third message is long.
std::string MadeRecords() {
  std::string channel, records;
  mcap::AppendInt(channel, std::uint16_t{5});
  mcap::AppendInt(channel, std::uint16_t{0});
  mcap::AppendString(channel, "/notes");
  mcap::AppendString(channel, "json");
  mcap::AppendInt(channel, std::uint32_t{0});
  records = Record(mcap::kChannel, channel);
  for (std::uint64_t i = 0; i < 3; ++i) {
    std::string message;
    mcap::AppendInt(message, std::uint16_t{5});
    mcap::AppendInt(message, static_cast<std::uint32_t>(i));
    mcap::AppendInt(message, 100 + i);
    mcap::AppendInt(message, 100 + i);
    message += "{\"text\":\"" + std::string(i == 2 ? 300 : 3, 'a') + "\"}";
    records += Record(mcap::kMessage, message);
  }
  return records;
}

// The contents of a chunk's record. `size` and `crc` are those of the uncompressed bytes; crc 0: not given.
struct Chunk {
  std::string compression, bytes;
  std::uint64_t size;
  std::uint32_t crc;
};

// A complete file that contains these chunks.
std::string FileOf(const std::vector<Chunk>& chunks) {
  std::string file(mcap::kMagic);
  std::string header, end, footer;
  mcap::AppendString(header, "");
  mcap::AppendString(header, "another program");
  file += Record(mcap::kHeader, header);
  for (const Chunk& c : chunks) {
    std::string chunk;
    mcap::AppendInt(chunk, std::uint64_t{100});
    mcap::AppendInt(chunk, std::uint64_t{102});
    mcap::AppendInt(chunk, c.size);
    mcap::AppendInt(chunk, c.crc);
    mcap::AppendString(chunk, c.compression);
    mcap::AppendInt(chunk, std::uint64_t{c.bytes.size()});
    file += Record(mcap::kChunk, chunk + c.bytes);
  }
  mcap::AppendInt(end, std::uint32_t{0});
  file += Record(mcap::kDataEnd, end) + Record(mcap::kFooter, std::string(20, '\0'));
  return file + std::string(mcap::kMagic);
}

const std::string kZstdRecords = FromHex(
    "28b52ffd0458bd020002440d15a0291df8b0eed93f5b461d8ce6b29d95eb67b12405abc80f18037fb37a772d9a0a6697"
    "8fedc1fe5152c97f146642c41ffcb670020e0026381500074000c81a10087a000240d6a032ba4200180c020e0c378021"
    "632636e8");
const std::string kLz4Records = FromHex(
    "04224d186440a76600000032041a000100f10705000000060000002f6e6f746573040000006a736f6e1a001724230059"
    "00006400000800e77b2274657874223a22616161227d2d005301000000650e001f652d0003244d012d00530200000066"
    "25001e662d000f0100ff1550616161227d00000000c9d96753");

// The messages that the reader finds in a file, and its error, or "".
std::vector<std::string> TextsOf(const std::string& file, McapReader::OnDamage on_damage,
                                 std::string& error) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "other.mcap";
  test::WriteAll(path, file);
  std::vector<std::string> texts;
  error.clear();
  auto reader = McapReader::Open(path, on_damage);
  if (!reader) {
    error = reader.error();
    return texts;
  }
  for (McapMessage message;;) {
    const auto more = reader->Next(message);
    if (!more) error = more.error();
    if (!more || !*more) return texts;
    EXPECT_EQ(message.channel->topic, "/notes");
    EXPECT_EQ(message.channel->schema_name, "");
    texts.emplace_back(message.bytes.begin(), message.bytes.end());
  }
}

const std::string kShort = "{\"text\":\"aaa\"}", kLong = "{\"text\":\"" + std::string(300, 'a') + "\"}";

// The messages of MadeRecords().
const std::vector<std::string> kTexts{kShort, kShort, kLong};

bool Contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(McapReader, ReadsChunksCompressedByOtherProgramsAndChannelsWithoutASchema) {
  const std::string records = MadeRecords();
  const std::uint32_t crc = mcap::Crc(0, records);
  std::string error;
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>{"", records}, {"zstd", kZstdRecords}, {"lz4", kLz4Records}})
    for (const std::uint32_t sum : {crc, 0u}) {  // 0: not given
      EXPECT_EQ(TextsOf(FileOf({{name, bytes, records.size(), sum}}), McapReader::OnDamage::kRefuse, error),
                kTexts)
          << name;
      EXPECT_EQ(error, "") << name;
    }
}

TEST(McapReader, RefusesChunksWithAWrongSizeChecksumOrCompression) {
  const std::string records = MadeRecords();
  const std::uint32_t crc = mcap::Crc(0, records);
  const std::uint64_t size = records.size();
  const auto refusal = [](const Chunk& chunk) {
    std::string error;
    EXPECT_TRUE(TextsOf(FileOf({chunk}), McapReader::OnDamage::kRefuse, error).empty());
    return error;
  };
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>{"zstd", kZstdRecords}, {"lz4", kLz4Records}}) {
    EXPECT_TRUE(Contains(refusal({name, bytes, size - 1, crc}), "chunk cannot be unpacked from " + name));
    EXPECT_TRUE(
        Contains(refusal({name, bytes, size + 1, crc}), "chunk unpacks to 467 bytes, announced are 468"));
    EXPECT_TRUE(Contains(refusal({name, bytes.substr(0, bytes.size() - 6), size, crc}),
                         "chunk cannot be unpacked from " + name));
    EXPECT_TRUE(Contains(refusal({name, "no such bytes", size, crc}), "cannot be unpacked from " + name));
    EXPECT_TRUE(Contains(refusal({name, bytes, size, crc + 1}), "does not match its CRC"));
    EXPECT_TRUE(Contains(refusal({name, bytes, std::uint64_t{1} << 60, crc}), "accepted up to 67108864"));
  }
  EXPECT_TRUE(Contains(refusal({"bz2", records, size, crc}),
                       "compressed with 'bz2', accepted: zstd, lz4, or not compressed"));
}

TEST(McapReader, ContinuesAtTheNextIntactChunkAfterADamagedOne) {
  const std::string records = MadeRecords();
  const std::uint32_t crc = mcap::Crc(0, records);
  std::string damaged = kZstdRecords;
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 0x55);
  std::string error;
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>{"zstd", kZstdRecords}, {"lz4", kLz4Records}})
    EXPECT_EQ(TextsOf(FileOf({{"zstd", damaged, records.size(), crc}, {name, bytes, records.size(), crc}}),
                      McapReader::OnDamage::kSkip, error),
              kTexts)
        << name << error;
}

}  // namespace
}  // namespace osteon::io
