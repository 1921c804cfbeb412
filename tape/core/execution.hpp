#pragma once
#include <cstdint>
#include <set>
#include <string>

/// Settings of the CPU back end for the whole process. Results never depend on them, and tests use them to show it.
namespace tape {
/// Limits the threads of every kernel that follows.  @param n  >= 1; 0 takes all cores
void set_threads(int n);
int threads();

/// A debug order for parallel_for: iterations run one by one in a random order, so that a kernel whose result depends on
/// the order of its iterations gives itself away.  @param seed  0 turns it off
void set_shuffled_order(std::uint64_t seed);
std::uint64_t shuffled_order();

/// While recording, the type names of launched kernels are collected: the test that every one exists for CUDA reads them.
void record_launches(bool on);
bool recording_launches();
void note_launch(const char* mangled_name);
std::set<std::string> recorded_launches();
}  // namespace tape
