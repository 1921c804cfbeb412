#include "tape/core/execution.hpp"

#include <cxxabi.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <atomic>
#include <cstdlib>
#include <memory>
#include <mutex>

#include "tape/core/error.hpp"

namespace tape {
namespace {
std::unique_ptr<tbb::global_control> g_limit;
int g_threads = 0;
std::atomic<std::uint64_t> g_shuffle = 0;
std::atomic<bool> g_recording = false;
std::mutex g_launch_mutex;
std::set<std::string> g_launches;
}  // namespace

void set_threads(int n) {
  TAPE_CHECK(n >= 0);
  g_threads = n > 0 ? n : tbb::info::default_concurrency();
  g_limit.reset();
  g_limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(g_threads));
}
int threads() { return g_threads > 0 ? g_threads : tbb::info::default_concurrency(); }

void set_shuffled_order(std::uint64_t seed) { g_shuffle = seed; }
std::uint64_t shuffled_order() { return g_shuffle; }

void record_launches(bool on) { g_recording = on; }
bool recording_launches() { return g_recording; }
void note_launch(const char* mangled_name) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> name(abi::__cxa_demangle(mangled_name, nullptr, nullptr, &status), std::free);
  const std::lock_guard lock(g_launch_mutex);
  g_launches.insert(status == 0 ? name.get() : mangled_name);
}
std::set<std::string> recorded_launches() {
  const std::lock_guard lock(g_launch_mutex);
  return g_launches;
}
}  // namespace tape
