#pragma once
/// One source for two back ends. Code that both compilers define stands in `namespace tape::TAPE_SIDE`;
/// functions that kernels call are marked TAPE_HD.
#ifdef __CUDACC__
#define TAPE_HD __host__ __device__
#define TAPE_SIDE on_cuda
#else
#define TAPE_HD
#define TAPE_SIDE on_cpu
#endif
