#include "tape/solver/block_matrix.inl"
#include "tape/solver/linear_solver.inl"
#include "tape/solver/pcg.inl"
#include "tape/solver/preconditioner.inl"
