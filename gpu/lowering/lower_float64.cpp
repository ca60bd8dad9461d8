// lower_float64 IN.spv OUT.spv OUT.h NAME: replaces doubles in a SPIR-V module (float64_lowering.h), and
// writes it also as a C array.
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <vector>

#include "gpu/lowering/float64_lowering.h"

int main(int count, char** arguments) try {
  if (count != 5) {
    std::fprintf(stderr, "usage: lower_float64 IN.spv OUT.spv OUT.h NAME\n");
    return 2;
  }
  std::ifstream in(arguments[1], std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  std::vector<std::uint32_t> module(bytes.size() / sizeof(std::uint32_t));
  if (module.size() < 5) throw std::runtime_error("no SPIR-V module");
  std::memcpy(module.data(), bytes.data(), module.size() * sizeof(std::uint32_t));
  module = osteon::gpu::LowerFloat64(module);
  std::ofstream spirv(arguments[2], std::ios::binary);
  spirv.write(reinterpret_cast<const char*>(module.data()),
              static_cast<std::streamsize>(module.size() * sizeof(std::uint32_t)));
  std::ofstream header(arguments[3]);
  header << "#pragma once\n\n#include <cstdint>\n\nconst uint32_t " << arguments[4] << "[] = {\n";
  for (std::size_t i = 0; i < module.size(); ++i) header << module[i] << (i % 10 == 9 ? ",\n" : ",");
  header << "};\n";
  if (!spirv.flush() || !header.flush()) throw std::runtime_error("can't be written");
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "lower_float64: %s: %s\n", count > 1 ? arguments[1] : "", error.what());
  return 1;
}
