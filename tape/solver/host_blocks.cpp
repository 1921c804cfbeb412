#include "tape/solver/host_blocks.hpp"

#include <algorithm>
#include <atomic>

namespace tape {
std::uint64_t next_pattern_id() {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

void merge_patterns(int n, const std::vector<std::uint64_t>& fixed, const std::vector<std::uint64_t>& contact, HostBlocks& host) {
  host.n = n;
  for (std::vector<int>* list : {&host.fixed, &host.contact, &host.col}) list->clear();
  host.row_begin.assign(static_cast<std::size_t>(n) + 1, 0);
  for (std::size_t f = 0, c = 0; f < fixed.size() || c < contact.size();) {
    const std::uint64_t key_f = f < fixed.size() ? fixed[f] : kNoBlock, key_c = c < contact.size() ? contact[c] : kNoBlock;
    const std::uint64_t key = key_f < key_c ? key_f : key_c;
    host.fixed.push_back(key == key_f ? static_cast<int>(f++) : -1);
    host.contact.push_back(key == key_c ? static_cast<int>(c++) : -1);
    host.col.push_back(static_cast<int>(key & 0xffffffffu));
    ++host.row_begin[static_cast<std::size_t>(key >> 32) + 1];
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) host.row_begin[i + 1] += host.row_begin[i];
  host.values.resize(host.col.size());
}

void sum_groups(Span<const Mat3> fixed, Span<const Mat3> contact, HostBlocks& host) {
  for (std::size_t k = 0; k < host.values.size(); ++k) {
    host.values[k] = host.fixed[k] >= 0 ? fixed[host.fixed[k]] : Mat3(Mat3::Zero());
    if (host.contact[k] >= 0) host.values[k] += contact[host.contact[k]];
  }
}

std::vector<int> fixed_profile(const HostBlocks& a, int first, int end) {
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  std::vector<int> profile;
  int far = 0;
  for (int i = first; i < end; ++i) {
    far = std::max(far, i + 1);
    for (int k = a.row_begin[at(i)]; k < a.row_begin[at(i) + 1]; ++k)
      if (a.fixed[at(k)] >= 0 && a.col[at(k)] < end) far = std::max(far, a.col[at(k)] + 1);
    profile.push_back(far - first);
  }
  return profile;
}
}  // namespace tape
