#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

// The folders for the seeds of make_corpus.cpp and make_file_corpus.cpp: one folder for each fuzz target.

namespace osteon {

using Bytes = std::vector<std::uint8_t>;

inline void Append(Bytes& to, const Bytes& more) { to.insert(to.end(), more.begin(), more.end()); }

/// The folder of one target's seeds, corpus/<target>; created if missing.
class Corpus {
 public:
  Corpus(const std::filesystem::path& root, const std::string& target) : folder_(root / target) {
    std::filesystem::create_directories(folder_);
  }
  void Write(const std::string& name, const Bytes& bytes) const {
    std::ofstream out(folder_ / name, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  /// Writes a seed. Its first byte selects how the target reads the rest.
  void Write(const std::string& name, std::uint8_t first, const std::string& rest) const {
    Bytes bytes{first};
    bytes.insert(bytes.end(), rest.begin(), rest.end());
    Write(name, bytes);
  }
  void Write(const std::string& name, const std::string& text) const {
    Write(name, Bytes(text.begin(), text.end()));
  }

 private:
  std::filesystem::path folder_;
};

/// Writes the seeds of all targets that read files; defined in make_file_corpus.cpp.
void WriteFiles(const std::filesystem::path& root);

}  // namespace osteon
