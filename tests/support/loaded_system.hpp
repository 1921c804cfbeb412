#pragma once
#include <utility>

#include "tape/solver/block_matrix.hpp"
#include "tests/support/strip_system.hpp"

namespace tape::test {
/// A strip system as the CPU side holds it.
struct LoadedSystem {
  StripSystem system;
  on_cpu::Buffer<std::uint64_t> fixed_keys, contact_keys;
  on_cpu::Buffer<Mat3> fixed_values, contact_values;
  on_cpu::Buffer<Vec3> points, b, x;
  on_cpu::BlockMatrix matrix;
  explicit LoadedSystem(StripSystem s)
      : system(std::move(s)),
        fixed_keys(system.fixed.keys),
        contact_keys(system.contact.keys),
        fixed_values(system.fixed.values),
        contact_values(system.contact.values),
        points(system.x),
        b(system.load()) {
    matrix.set_fixed_pattern(system.n, fixed_keys.span());
    matrix.set_contact_pattern(contact_keys.span());
    matrix.accumulate_fixed(fixed_values.span());
    matrix.accumulate_contact(contact_values.span());
    x.resize(system.n);
  }
};
}  // namespace tape::test
