#include "tape/core/hash.hpp"

#include <fstream>

namespace tape {
void Hash::add_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  for (char block[1 << 16]; in.read(block, sizeof block) || in.gcount() > 0;) add(block, static_cast<std::size_t>(in.gcount()));
}

const Hash& program_hash() {
  static const Hash hash = [] {
    Hash h;
    h.add_file("/proc/self/exe");
    return h;
  }();
  return hash;
}
}  // namespace tape
