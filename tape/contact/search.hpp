#pragma once
#include <algorithm>
#include <vector>

#include "tape/contact/groups.hpp"
#include "tape/contact/hits.hpp"
#include "tape/contact/kernels.inl"
#include "tape/contact/surface_buffers.hpp"

namespace tape::TAPE_SIDE {
/// What the search did so far, for the report.
struct SearchReport {
  int rebuilds = 0, reuses = 0;
  int vertex_triangle = 0, edge_edge = 0;  ///< candidates now
  long long capped = 0;                    ///< pairs whose CCD ran out of iterations, over the run: safe but short steps
};

/// Candidate pairs of a surface, valid while every vertex stays in its trust box, and the step limits that follow from them.
/// The candidates hold every admissible pair that can come within dhat (edge-edge: the guard's reach) of touching there; their order
/// (vertex-triangle, then edge-edge, each sorted by the primitives' ids) depends on nothing but the pairs themselves. README.md has the
/// reasoning.
class ContactSearch {
 public:
  /// @param dhat   [m] activation distance beyond xi
  /// @param guard  [m] that of edge-edge pairs and of the barrier at open rims, <= dhat
  /// @param everywhere  look at all primitives from the world, in company or not
  ContactSearch(const SurfaceMesh& mesh, Real dhat, Real guard, bool everywhere = false);
  /// What carries each vertex from now on. Members of clusters are looked for where they are at home, in trees that are planted once.
  void set_carriage(const SurfaceCarriage& carriage);
  /// Which objects somebody else keeps apart from now on, as SurfaceMesh::apart.
  void set_apart(const std::vector<char>& apart);
  /// Makes the candidates good for the whole of `paths`.
  /// @param margin  [m] by which the boxes of a rebuild exceed the paths: larger is reused longer, and finds more
  /// @return whether they had to be rebuilt
  bool update(const PathView& paths, Real margin);
  /// Finds the candidates anew, whatever is known.
  void rebuild(const PathView& paths, Real margin);
  /// Whether a rebuild would find no more than `most` pairs for each vertex and edge that it looks at. Paths that sweep the layers of a
  /// roll through each other meet nearly all of them. What was known is forgotten.
  bool within(const PathView& paths, Real margin, int most);
  /// Pairs that something else holds apart, sorted by key, each once: they leave the candidates, and CCD only keeps them from crossing.
  void set_bonded(const std::vector<VertexTriangle>& bonded);
  /// They, with their constants; xi and dhat are 0.
  Span<const ContactPair> bonded() const { return bonded_.span(); }
  /// Makes the next update a rebuild.
  void forget() { built_ = false; }
  Span<const ContactPair> candidates() const { return pairs_.span(); }
  detail::SurfaceView surface() const { return surface_.view(); }
  /// For samples of the surface where `paths` start, which must be where the candidates are good.
  detail::SampleQuery samples(const PathView& paths);
  const SearchReport& report() const { return report_; }

  /// Largest share of the step along `paths` for each object, in [0, 1]; equal for objects that candidates connect.
  /// Call after update() with the same paths. Fixed objects do not connect others; their value is 1.
  std::vector<Real> limit_steps(const PathView& paths, const CcdSettings& settings);
  /// Multiplies each block of a direction by the limit last found for what it moves.
  void scale(Span<Vec3> direction) const;

 private:
  /// What one viewpoint shows, in the memory of this side.
  struct Seen {
    Buffer<detail::Trust> trust;
    Buffer<detail::EdgeShape> edges;
    Buffer<detail::TriangleShape> triangles;
    detail::Sight view() const { return {trust.span(), edges.span(), triangles.span()}; }
  };
  struct Planted {
    BoxTree vertices, edges, triangles;
    int size = 0;  ///< primitives
  };
  void resize(Seen& seen) const;
  void look(const PathView& paths, Real margin);
  void find_company();
  /// What looks for pairs.
  const detail::Primitives& in_view() const { return surface_.alone ? surface_.followers : in_company_.asking; }
  template <class F>
  void query(const F& f);
  void find_frames(const PathView& paths);
  void make_shapes(const detail::Primitives& list, Seen& seen);
  void plant(const detail::Primitives& list, const Seen& seen, bool vertices, Planted& trees);
  void drop_bonded();
  void join_components(const detail::SurfaceView& s);

  SurfaceMesh mesh_;
  detail::SurfaceBuffers surface_;
  ObjectGroups groups_;
  Buffer<Pose> frame_origin_;     ///< [frames] at the rebuild
  Buffer<FramePath> frames_;      ///< [frames]
  Seen own_, world_;              ///< what follows a frame from there; all from the world, where that matters
  Buffer<Box> object_boxes_;      ///< [objects]
  Buffer<int> partners_;          ///< [objects objects] of each object, that it may touch from the world's view
  Buffer<int> partner_count_;     ///< [objects]
  Buffer<Box> meetings_;          ///< [objects objects] where each meets its partners
  detail::Primitives looked_at_;  ///< of objects with partners or a frame
  struct {
    detail::Primitives asking, rest, outside, followers;
  } in_company_;  ///< what may touch a partner where it meets the object; asking: and all that is awake and seen from a frame
  Planted own_trees_, asleep_trees_, rest_trees_, outside_trees_, follower_trees_;
  Buffer<Lanes> boxes_;
  detail::Hits vertex_hits_, sleeper_hits_, edge_hits_;
  Buffer<VertexTriangle> bonded_names_;
  Buffer<ContactPair> bonded_, found_, pairs_;
  Buffer<int> kept_;       ///< [found + 1]
  Buffer<Real> touching_;  ///< [objects objects]
  Buffer<int> component_;  ///< [objects] -1: fixed
  Buffer<int> block_object_;
  Buffer<Real> limit_;  ///< [components]
  SearchReport report_;
  bool everywhere_, built_ = false;
};
}  // namespace tape::TAPE_SIDE

#include "tape/contact/search.inl"
