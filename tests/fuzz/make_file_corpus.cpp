#include <zlib.h>

#include <array>
#include <regex>

#include "io/recording/mcap_writer.h"
#include "io/recording/messages.h"
#include "session/procedure/session_file.h"
#include "simulation/engine/reference_engine.h"
#include "simulation/files/carved_file.h"
#include "simulation/packing/packing_text.h"
#include "simulation/tools/tool_motion.h"
#include "tests/fuzz/corpus_folder.h"
#include "tests/io/recording/recording_samples.h"
#include "tests/io/temporary_folder.h"
#include "tests/session/procedure/session_samples.h"
#include "tests/simulation/files/carved_samples.h"
#include "tests/simulation/mesh/mesh_shapes.h"
#include "tests/simulation/packing/packing_samples.h"

// Writes the seeds of all fuzz targets that read files. Nearly all seeds are valid files of a few kB. Where
// the program has a writer for a kind of file, the writer makes the seed.

namespace osteon {
namespace {

// ---- YAML constructs that occur in no shipped file

constexpr const char* kYaml = R"(# every kind of value
name: 'a: text'
radius_mm: 12.5
at_mm: [1, -2, 3e1]
axis: [0, 0, 1]
turn_ratio: [0.6, 0.8]
joint_count: 7
locked: [x, rx]
burr: {kind: cup, acts: true, empty:}
rows:
  - {radius_mm: 1, name: &a one}
  - radius_mm: 2
    name: *a
long: |
  two
  lines
tag: !!str 7
)";

constexpr const char* kGains = R"(admittance:
  mass_kg: [8, 8, 8]
  damping_Ns_per_m: [60, 60, 60]
coupling:
  max_stiffness_N_per_mm: 15
)";

constexpr const char* kCalibration = R"(payload:
  mass_kg: 0.9
  center_mm: [0, 0, 60]
  bias_N: [0.1, -0.2, 0.3]
  bias_Nm: [0.01, 0, 0]
tcp_mm: [0, 0, 300]
)";

void WriteConfig(const std::filesystem::path& root) {
  Corpus(root, "yaml").Write("values", kYaml);
  const Corpus files(root, "config_file");
  files.Write("gains", kGains);
  files.Write("calibration", kCalibration);
}

// Writes the shipped tools with few and coarse balls, because fitting many balls takes too long for a fuzzer.
void WriteTools(const std::filesystem::path& root) {
  const std::array<std::pair<std::regex, const char*>, 3> changes{
      {{std::regex("_gap_ratio: [0-9.]+"), "_gap_ratio: 0.5"},
       {std::regex("_gap_mm: [0-9.]+"), "_gap_mm: 5"},
       {std::regex("max_count: [0-9]+"), "max_count: 20"}}};
  for (const char* name : {"reamer", "round_burr", "twist_drill"}) {
    std::string text = io::test::ReadAll(OSTEON_SOURCE_DIR "/config/tools/" + std::string(name) + ".yaml");
    for (const auto& [from, to] : changes) text = std::regex_replace(text, from, to);
    Corpus(root, "tool_file").Write(name, text);
  }
}

// ---- pictures: the smallest PNG files, written here because the program has no writer for them

std::string BigEndian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

// A chunk of a PNG file, with length and CRC.
std::string PngChunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const uLong crc = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return BigEndian(static_cast<std::uint32_t>(data.size())) + body +
         BigEndian(static_cast<std::uint32_t>(crc));
}

/// A grey PNG of 4 × 3 samples. @param bits  number of bits per sample
std::string Png(char bits) {
  const std::size_t row = static_cast<std::size_t>(4 * bits + 7) / 8;
  std::string rows;
  for (char r = 0; r < 3; ++r) rows += '\0' + std::string(row, static_cast<char>(40 * r));
  std::array<Bytef, 100> packed{};
  uLongf size = packed.size();
  compress(packed.data(), &size, reinterpret_cast<const Bytef*>(rows.data()), rows.size());
  return "\x89PNG\r\n\x1a\n" +
         PngChunk("IHDR", BigEndian(4) + BigEndian(3) + bits + std::string("\0\0\0\0", 4)) +
         PngChunk("gAMA", BigEndian(45455)) +
         PngChunk("IDAT", std::string(reinterpret_cast<const char*>(packed.data()), size)) +
         PngChunk("IEND", "");
}

// ---- meshes

void WriteMeshes(const std::filesystem::path& root) {
  using namespace simulation;
  const Corpus corpus(root, "mesh");
  const TriangleMesh box = MakeBox({-0.01, -0.02, -0.03}, {0.01, 0.02, 0.03});
  const TriangleMesh region = MakeBox({-0.005, -0.01, -0.015}, {0.005, 0.01, 0.015});
  corpus.Write("box_stl", 0, StlText(box));
  corpus.Write("box_binary_stl", 0, BinaryStl(box));
  corpus.Write("regions_obj", 1, "o bone\n" + ObjText(box) + "g core\n" + ObjText(region, 8));
  corpus.Write("quads_obj", 1,
               "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nv 0 0 10 1\nv 10 0 10\nv 10 10 10\nv 0 10 10\n"
               "vt 0 0\nvn 0 0 1\n# a cube\nusemtl x\nf 4/1/1 3/1/1 2/1/1 1/1/1\nf 5//1 6//1 7//1 8//1\n"
               "f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf -5 -8 -4 -1\n");
  corpus.Write("box_ply", 2, PlyText(box));
  corpus.Write("box_binary_ply", 2, BinaryPly(box));
  // kinds of wrong meshes that the checks once accepted, and that then made later code fail
  const std::string obj = ObjText(box), ply = PlyText(box);
  const std::size_t faces = ply.find("element face"), end = ply.find("end_header\n");
  const std::string camera = "element camera 1\nproperty float view_px\nproperty list uchar short viewport\n";
  corpus.Write("camera_first_ply", 2,
               "ply\nformat ascii 1.0\n" + camera + ply.substr(21, end - 21) + "end_header\n1.5 2 640 480\n" +
                   ply.substr(end + 11));
  corpus.Write("element_twice_ply", 2,
               ply.substr(0, faces) + "element vertex 24\nproperty float x\n" + ply.substr(faces));
  corpus.Write("rows_behind_the_last_ply", 2, ply + "3 0 1 2\n");
  corpus.Write("big_endian_faces_first_ply", 2,
               "ply\nformat binary_big_endian 1.0\nelement face 1\nproperty list uchar uchar vertex_index\n"
               "element vertex 3\nproperty char x\nproperty char y\nproperty char z\nend_header\n" +
                   std::string("\3\0\1\2\0\0\0\1\0\0\0\1\0", 13));
  corpus.Write("comments_indents_obj", 1,
               "\xef\xbb\xbf# C:\\bones\\\n  " + obj + "  g a \\\n\tf 1 \\\n 2 3 # C:\\\nf 1/ 2// 3 3\n");
  corpus.Write(
      "concave_obj", 1,
      "v 0 0 0\nv 9 0 0\nv 9 9 0\nv 4 1 0\nv 2 9 0\nv 1 1 0\nv 0 9 0\nf 1 2 3 4 5 6 7\nf 7 6 5 4 3 2 1\n");
  corpus.Write("marked_stl", 0, "\xef\xbb\xbf" + StlText(box));
  corpus.Write("lfs_pointer_stl", 0, "version https://git-lfs.github.com/spec/v1\nsize 2500084\n");
}

// ---- files that this program writes

void WriteSimulation(const std::filesystem::path& root, const io::test::TemporaryFolder& folder) {
  using namespace simulation;
  const auto file = folder.path() / "file";
  const Bone bone = test::SomeBone(6, 5);
  if (WritePackingFile(file, bone, test::SomeProvenance()))
    for (const bool seal : {false, true})
      Corpus(root, "packing").Write(seal ? "sealed" : "as_it_is", seal ? 1 : 0, io::test::ReadAll(file));
  const Corpus texts(root, "packing_text");
  if (const auto text = MaterialsToText(bone.materials)) texts.Write("materials", 1, *text);
  if (const auto text = ProvenanceToText({.name = "some bone", .provenance = test::SomeProvenance()}))
    texts.Write("provenance", 0, *text);

  ReferenceEngine engine(test::CarvedBone(), test::CarvedTool(), Pose::Identity(), test::CarvedParams());
  for (int i = 0; i < 6; ++i) engine.Step(test::CarvedFrame(6e-3 - 0.2e-3 * i));
  if (WriteCarvedState(file, engine.Snapshot(), test::CarvedBone()))
    for (const bool seal : {false, true})
      Corpus(root, "carved").Write(seal ? "sealed" : "as_it_is", seal ? 1 : 0, io::test::ReadAll(file));

  ToolMotion motion;
  motion.origin.made_by = "a test";
  for (int i = 0; i < 5; ++i)
    motion.samples.push_back({.time_s = 0.01 * i,
                              .p_GT_m = Vector3(1e-3 * i, 0, 0.02),
                              .R_GT = Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * i, Vector3::UnitX())),
                              .spindle_rad_per_s = 26.0});
  Corpus(root, "motion").Write("five_rows", MotionText(motion));
  motion.samples.resize(2);
  Corpus(root, "motion").Write("two_rows", MotionText(motion));
}

void WriteRecordings(const std::filesystem::path& root, const io::test::TemporaryFolder& folder) {
  std::array<std::string, 4> messages;
  io::Encode(io::test::SomeSession(), messages[0]);
  io::Encode(io::test::SomeTick(1), messages[1]);
  io::Encode(io::test::SomeFrame(1), messages[2]);
  io::Encode(io::RecordedEvent{.stamp = 5, .text = "an event"}, messages[3]);
  constexpr std::array<const char*, 4> kNames{"Session", "Tick", "Frame", "Event"};
  for (std::uint8_t i = 0; i < 4; ++i) Corpus(root, "recording_message").Write(kNames[i], i, messages[i]);

  // without the text of the schemas, which takes 10 kB and is used by no reader
  const auto path = folder.path() / "recording";
  auto writer = io::McapWriter::Create(path, "osteon", {.chunk_bytes = 2000, .compress = false});
  if (!writer) return;
  std::array<std::uint16_t, 4> channels{};
  for (std::size_t i = 0; i < 4; ++i)
    channels[i] = writer->AddChannel(kNames[i], std::string("osteon.") + kNames[i], "");
  for (const std::size_t i : {0, 1, 2, 3, 1})
    writer->Write(channels[i], static_cast<std::int64_t>(i), messages[i]);
  if (!writer->Finish()) return;
  const std::string whole = io::test::ReadAll(path);
  const Corpus corpus(root, "recording");
  corpus.Write("whole", 0, whole);
  corpus.Write("without_checksums", 1, whole);
  corpus.Write("torn", 1, whole.substr(0, whole.size() / 2));
}

// ---- session.json: of a complete session, of a killed process, and an empty one

void WriteSessions(const std::filesystem::path& root) {
  const Corpus corpus(root, "session_file");
  session::SessionFile session = session::test::SomeSession();
  corpus.Write("killed", session::ToJson(session));
  session.ended = true;
  session.segments.back().end = 5'000'000'000;
  session.passes.back().to_go_mm = -0.25;
  session.cup_X_GT = Pose::Identity();
  corpus.Write("ended", session::ToJson(session));
  session.segments.clear();
  session.passes.clear();
  corpus.Write("begun", session::ToJson(session));
}

}  // namespace

void WriteFiles(const std::filesystem::path& root) {
  const io::test::TemporaryFolder folder;
  WriteConfig(root);
  WriteTools(root);
  Corpus(root, "density_image").Write("grey_8", Png(8));
  Corpus(root, "density_image").Write("grey_16", Png(16));
  Corpus(root, "density_image").Write("grey_4", Png(4));
  WriteMeshes(root);
  WriteSimulation(root, folder);
  WriteRecordings(root, folder);
  WriteSessions(root);
}

}  // namespace osteon
