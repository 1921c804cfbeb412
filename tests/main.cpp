#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstdint>
#include <cstdlib>
#include <string>

#include "tape/core/execution.hpp"

namespace {
/// Runs every test in a shuffled order of kernel iterations, another one in each repetition (--gtest_repeat).
class ShuffledIterations : public testing::EmptyTestEventListener {
 public:
  explicit ShuffledIterations(std::uint64_t seed) : seed_(seed) {}
  void OnTestIterationStart(const testing::UnitTest&, int repetition) override { repetition_ = static_cast<std::uint64_t>(repetition); }
  void OnTestStart(const testing::TestInfo&) override { tape::set_shuffled_order(seed_ + repetition_); }

 private:
  std::uint64_t seed_, repetition_ = 0;
};
}  // namespace

/// TAPE_SHUFFLE=SEED in the environment (SEED > 0) shuffles the iterations of all kernels.
int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (const char* seed = std::getenv("TAPE_SHUFFLE"))
    testing::UnitTest::GetInstance()->listeners().Append(new ShuffledIterations(std::stoull(seed)));
  // So that set_threads(8) means eight threads on a machine of two cores.
  const tbb::global_control most(tbb::global_control::max_allowed_parallelism, 8);
  tbb::task_arena arena(8);
  arena.initialize();
  tape::set_threads(0);
  return arena.execute([] { return RUN_ALL_TESTS(); });
}
