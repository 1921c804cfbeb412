#pragma once
#include <climits>

#include "tape/contact/pair.hpp"
#include "tape/core/functors.hpp"
#include "tape/core/side.hpp"

/// From queries to pairs: count, scan, emit. The pairs of each query stand together, sorted by the other primitive's id.
namespace tape::TAPE_SIDE::detail {
inline constexpr int kSlots = 32;  // hits of one query kept from the count; a query with more is made twice

template <class Query>
struct CountHits {
  Query query;
  Span<int> slots;  ///< [queries kSlots]
  Span<int> count;  ///< [queries]
  TAPE_HD void operator()(int i) const {
    int n = 0;
    query.visit(i, [&](int other) {
      if (n < kSlots) slots[i * kSlots + n] = other;
      ++n;
    });
    count[i] = n;
  }
};

TAPE_HD inline void sort_few(int* a, int n) {
  for (int k = 1; k < n; ++k) {
    const int value = a[k];
    int at = k;
    for (; at > 0 && a[at - 1] > value; --at) a[at] = a[at - 1];
    a[at] = value;
  }
}
TAPE_HD inline void sift_down(int* a, int root, int n) {
  for (int child; (child = 2 * root + 1) < n; root = child) {
    if (child + 1 < n && a[child + 1] > a[child]) ++child;
    if (a[root] >= a[child]) return;
    const int value = a[root];
    a[root] = a[child], a[child] = value;
  }
}
TAPE_HD inline void sort_many(int* a, int n) {  // heap sort
  for (int root = n / 2 - 1; root >= 0; --root) sift_down(a, root, n);
  for (int last = n - 1; last > 0; --last) {
    const int value = a[0];
    a[0] = a[last], a[last] = value;
    sift_down(a, 0, last);
  }
}

struct Count {
  Span<const int> of;
  TAPE_HD long long operator()(int i) const { return of[i]; }
};

template <class Query>
struct EmitPairs {
  Query query;
  Span<const int> slots, first;  ///< first: [queries] where the hits of each query begin
  Span<int> hits;
  Span<ContactPair> pairs;
  TAPE_HD void operator()(int i) const {
    const int begin = first[i], n = (i + 1 < first.size ? first[i + 1] : hits.size) - begin;
    int* const mine = hits.data + begin;
    if (n <= kSlots) {
      for (int k = 0; k < n; ++k) mine[k] = slots[i * kSlots + k];
      sort_few(mine, n);
    } else {
      int k = 0;
      query.visit(i, [&](int other) { mine[k++] = other; });
      sort_many(mine, n);
    }
    for (int k = 0; k < n; ++k) pairs[begin + k] = query.pair(i, mine[k]);
  }
};

/// Hits of one kind of query. A query has visit(i, f), which calls f(other), and pair(i, other).
class Hits {
 public:
  /// @return number of all hits; with more than INT_MAX there is nothing to emit
  template <class Query>
  long long count(int queries, const Query& query) {
    first_.resize(queries), slots_.resize(queries * kSlots);
    parallel_for(queries, CountHits<Query>{query, slots_.span(), first_.span()}, kFew);
    const long long all = reduce(queries, 0LL, Count{first_.span()}, Plus{});
    if (all <= INT_MAX) exclusive_scan(first_.span());
    return all;
  }
  /// @param pairs  as many as count() returned for the same query
  template <class Query>
  void emit(const Query& query, Span<ContactPair> pairs) {
    hits_.resize(pairs.size);
    parallel_for(first_.size(), EmitPairs<Query>{query, slots_.span(), first_.span(), hits_.span(), pairs}, kFew);
  }

 private:
  Buffer<int> first_, slots_, hits_;
};
}  // namespace tape::TAPE_SIDE::detail
