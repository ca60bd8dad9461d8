// spirv_array IN.spv OUT.h NAME: writes a SPIR-V module as a C array.
// spirv_array IN.spv OUT.h NAME LOWERED.spv: replaces its doubles first (float64_lowering.h), and also writes
// the module without doubles to LOWERED.spv.
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "gpu/lowering/float64_lowering.h"

namespace {

std::vector<std::uint32_t> ReadModule(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  std::vector<std::uint32_t> module(bytes.size() / sizeof(std::uint32_t));
  if (module.size() < 5)
    throw std::runtime_error("found " + std::to_string(bytes.size()) + " bytes, accepted a SPIR-V module");
  std::memcpy(module.data(), bytes.data(), module.size() * sizeof(std::uint32_t));
  return module;
}

void WriteModule(const std::string& file, const std::vector<std::uint32_t>& module) {
  std::ofstream spirv(file, std::ios::binary);
  spirv.write(reinterpret_cast<const char*>(module.data()),
              static_cast<std::streamsize>(module.size() * sizeof(std::uint32_t)));
  if (!spirv.flush()) throw std::runtime_error(file + ": cannot write it");
}

void WriteArray(const std::string& file, const std::string& name, const std::vector<std::uint32_t>& module) {
  std::ofstream header(file);
  header << "#pragma once\n\n#include <cstdint>\n\nconst uint32_t " << name << "[] = {\n";
  for (std::size_t i = 0; i < module.size(); ++i) header << module[i] << (i % 10 == 9 ? ",\n" : ",");
  header << "};\n";
  if (!header.flush()) throw std::runtime_error(file + ": cannot write it");
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 4 && count != 5) {
    std::fprintf(stderr, "usage: spirv_array IN.spv OUT.h NAME [LOWERED.spv]\n");
    return 2;
  }
  std::vector<std::uint32_t> module = ReadModule(arguments[1]);
  if (count == 5) {
    module = osteon::gpu::LowerFloat64(module);
    WriteModule(arguments[4], module);
  }
  WriteArray(arguments[2], arguments[3], module);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "spirv_array: %s: %s\n", count > 1 ? arguments[1] : "", error.what());
  return 1;
}
