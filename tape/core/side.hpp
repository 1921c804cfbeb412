#pragma once
/// Buffer, parallel_for, reduce, sort_by_key and exclusive_scan of the side that is being compiled.
/// Only core/ names CUDA or launches work; everything else is written against these names in `namespace tape::TAPE_SIDE`.
#include "tape/core/hd.hpp"
#ifdef __CUDACC__
#include "tape/core/side_cuda.hpp"
#else
#include "tape/core/side_cpu.hpp"
#endif
