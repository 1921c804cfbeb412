#pragma once

namespace tape {
/// Holds OpenBLAS to one thread: its results differ in the last bits with the number of threads, whatever `--threads` says.
/// Does nothing for a BLAS without threads.
void fix_blas_threads();
}  // namespace tape
