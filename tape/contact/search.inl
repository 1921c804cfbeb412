#pragma once

namespace tape::TAPE_SIDE {
inline ContactSearch::ContactSearch(const SurfaceMesh& mesh, Real dhat, Real guard)
    : surface_(mesh, dhat, guard), groups_(mesh), component_(groups_.component_of_object), block_object_(groups_.object_of_block) {
  TAPE_CHECK(mesh.owner.size() == mesh.vertices.size() && guard > 0 && guard <= dhat);
  TAPE_CHECK(std::max(mesh.edges.size(), mesh.triangles.size()) < (1u << 24));
}

inline bool ContactSearch::update(const PathView& paths, Real margin) {
  if (built_ &&
      reduce(surface_.vertices.size(), true, detail::InTrust{surface_.view(), paths, trust_.span(), leader_start_.span()}, detail::And{})) {
    ++report_.reuses;
    return false;
  }
  rebuild(paths, margin);
  return true;
}

inline void ContactSearch::rebuild(const PathView& paths, Real margin) {
  const detail::SurfaceView s = surface_.view();
  trust_.resize(s.vertices.size), ball_.resize(s.vertices.size);
  triangle_boxes_.resize(s.triangles.size), triangles_.resize(s.triangles.size);
  edge_boxes_.resize(s.edges.size), edges_.resize(s.edges.size);
  parallel_for(s.vertices.size, detail::MakeTrust{s, paths, margin, trust_.span(), ball_.span()});
  leader_start_.resize(s.leader.size);
  parallel_for(s.leader.size, detail::StoreLeaders{s, paths, leader_start_.span()});
  parallel_for(s.triangles.size, detail::MakeTriangles{s, trust_.span(), ball_.span(), triangle_boxes_.span(), triangles_.span()});
  parallel_for(s.edges.size, detail::MakeEdges{s, trust_.span(), ball_.span(), edge_boxes_.span(), edges_.span()});
  triangle_tree_.build(triangle_boxes_.span());
  edge_tree_.build(edge_boxes_.span());
  const detail::VertexQuery vertices{s, trust_.span(), ball_.span(), triangles_.span(), triangle_tree_.view()};
  const detail::EdgeQuery edges{s, trust_.span(), edges_.span(), edge_tree_.view()};
  report_.vertex_triangle = vertex_hits_.count(s.vertices.size, vertices);
  report_.edge_edge = edge_hits_.count(s.edges.size, edges);
  Buffer<ContactPair>& all = bonded_.size() > 0 ? found_ : pairs_;
  all.resize(report_.vertex_triangle + report_.edge_edge);
  const Span<ContactPair> pairs = all.span();
  vertex_hits_.emit(vertices, Span<ContactPair>{pairs.data, report_.vertex_triangle});
  edge_hits_.emit(edges, Span<ContactPair>{pairs.data + report_.vertex_triangle, report_.edge_edge});
  if (bonded_.size() > 0) drop_bonded();
  join_components(s);
  built_ = true;
  ++report_.rebuilds;
}

inline void ContactSearch::set_bonded(const std::vector<VertexTriangle>& bonded) {
  bonded_names_.upload(bonded);
  bonded_.resize(bonded_names_.size());
  parallel_for(bonded_.size(), detail::MakeBonded{surface_.view(), bonded_names_.span(), bonded_.span()});
  forget();
}

inline void ContactSearch::drop_bonded() {
  kept_.resize(found_.size() + 1);
  parallel_for(kept_.size(), detail::FlagUnbonded{found_.span(), bonded_names_.span(), kept_.span()});
  const int left = exclusive_scan(kept_.span());
  report_.vertex_triangle -= found_.size() - left;
  pairs_.resize(left);
  parallel_for(found_.size(), detail::KeepFlagged{found_.span(), kept_.span(), pairs_.span()});
}

inline void ContactSearch::join_components(const detail::SurfaceView& s) {
  const int n = groups_.objects();
  touching_.resize(n * n);
  parallel_for(n * n, detail::Fill{touching_.span(), 1.0});
  for (const Buffer<ContactPair>* pairs : {&pairs_, &bonded_})
    parallel_for(pairs->size(), detail::MarkTouching{pairs->span(), s.vertices, n, touching_.span()});
  groups_.join(touching_.download());
  component_.upload(groups_.component_of_object);
}

inline std::vector<Real> ContactSearch::limit_steps(const PathView& paths, const CcdSettings& settings) {
  limit_.resize(groups_.components);
  parallel_for(limit_.size(), detail::Fill{limit_.span(), 1.0});
  for (const Buffer<ContactPair>* pairs : {&pairs_, &bonded_}) {
    const detail::LimitStep kernel{pairs->span(), paths, settings, surface_.vertices.span(), component_.span(), limit_.span()};
    report_.capped += reduce(pairs->size(), 0, kernel, detail::Plus{});
  }
  const std::vector<Real> limit = limit_.download();
  std::vector<Real> of_object;
  for (int c : groups_.component_of_object) of_object.push_back(c < 0 ? 1.0 : limit[static_cast<std::size_t>(c)]);
  return of_object;
}

inline void ContactSearch::scale(Span<Vec3> direction) const {
  parallel_for(direction.size, detail::ScaleBlocks{block_object_.span(), component_.span(), limit_.span(), direction});
}
}  // namespace tape::TAPE_SIDE
