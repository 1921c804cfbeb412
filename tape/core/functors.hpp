#pragma once
#include "tape/core/types.hpp"

/// Values and combinations of reductions that several folders need.
namespace tape {
struct Plus {
  template <class T>
  TAPE_HD T operator()(const T& a, const T& b) const {
    return a + b;
  }
};
/// What is no number stays, in whatever order.
struct Smaller {
  template <class T>
  TAPE_HD T operator()(const T& a, const T& b) const {
    return a < b || a != a ? a : b;
  }
};
struct Larger {
  template <class T>
  TAPE_HD T operator()(const T& a, const T& b) const {
    return a > b || a != a ? a : b;
  }
};
struct Both {
  TAPE_HD bool operator()(bool a, bool b) const { return a && b; }
};
/// Term i of the scalar product of two fields.
struct Dot {
  Span<const Vec3> a, b;
  TAPE_HD Real operator()(int i) const { return a[i].dot(b[i]); }
};
}  // namespace tape
