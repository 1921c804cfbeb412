#pragma once

namespace tape::TAPE_SIDE {
inline ContactSearch::ContactSearch(const SurfaceMesh& mesh, Real dhat, Real guard, bool everywhere)
    : mesh_(mesh),
      surface_(mesh, dhat, guard),
      groups_(mesh),
      component_(groups_.component_of_object),
      block_object_(groups_.object_of_block),
      everywhere_(everywhere) {
  TAPE_CHECK(mesh.owner.size() == mesh.vertices.size() && guard > 0 && guard <= dhat);
  TAPE_CHECK(std::max(mesh.edges.size(), mesh.triangles.size()) < (1u << 24));
}

inline void ContactSearch::set_carriage(const SurfaceCarriage& carriage) {
  mesh_.owner = carriage.owner, mesh_.follows = carriage.follows;
  const std::vector<int> slept = surface_.asleep.vertices.download();
  surface_.set_carriage(mesh_, carriage.clusters, carriage.resting);
  groups_ = ObjectGroups(mesh_);
  component_.upload(groups_.component_of_object);
  block_object_.upload(groups_.object_of_block);
  forget();
  const bool only_woken = std::ranges::includes(slept, surface_.asleep.vertices.download());
  if (only_woken && 2 * surface_.asleep.size() > asleep_trees_.size) return;  // what has woken stays in the trees and is passed over
  resize(own_);
  const Buffer<Vec3> home(carriage.home);
  const Span<const int> vertices = surface_.asleep.vertices.span();
  parallel_for(vertices.size, detail::MakeHomeTrust{home.span(), vertices, own_.trust.span()});
  make_shapes(surface_.asleep, own_);
  plant(surface_.asleep, own_, true, asleep_trees_);
}

inline void ContactSearch::set_apart(const std::vector<char>& apart) {
  surface_.set_apart(apart);
  forget();
}

inline void ContactSearch::resize(Seen& seen) const {
  seen.trust.resize(surface_.vertices.size());
  seen.edges.resize(surface_.edges.size());
  seen.triangles.resize(surface_.triangles.size());
}

inline bool ContactSearch::update(const PathView& paths, Real margin) {
  if (built_) {
    find_frames(paths);
    const detail::SurfaceView s = surface_.view();
    const Span<const int> vertices = surface_.in_view().vertices.span();
    const detail::InTrust kernel{{s, paths, frames_.span()}, {s, paths, {}}, vertices, own_.trust.span(), world_.trust.span()};
    if (reduce(vertices.size, true, kernel, Both{})) {
      ++report_.reuses;
      return false;
    }
  }
  rebuild(paths, margin);
  return true;
}

inline void ContactSearch::find_frames(const PathView& paths) {
  frames_.resize(frame_origin_.size());
  parallel_for(frames_.size(), detail::MakeFrames{surface_.view(), paths, frame_origin_.span(), frames_.span()});
}

inline detail::SampleQuery ContactSearch::samples(const PathView& paths) {
  find_frames(paths);
  const detail::Trees trees{own_trees_.triangles.view(), asleep_trees_.triangles.view(), rest_trees_.triangles.view(),
                            outside_trees_.triangles.view(), follower_trees_.triangles.view()};
  return {surface_.view(), trees, frames_.span(), paths.x};
}

inline void ContactSearch::make_shapes(const detail::Primitives& list, Seen& seen) {
  const detail::SurfaceView s = surface_.view();
  parallel_for(list.edges.size(), detail::MakeEdges{s, seen.trust.span(), list.edges.span(), seen.edges.span()});
  parallel_for(list.triangles.size(), detail::MakeTriangles{s, seen.trust.span(), list.triangles.span(), seen.triangles.span()});
}

inline void ContactSearch::plant(const detail::Primitives& list, const Seen& seen, bool vertices, Planted& trees) {
  const detail::SurfaceView s = surface_.view();
  trees.size = list.size();
  boxes_.resize(list.edges.size());
  parallel_for(boxes_.size(), detail::BoxEdges{s, seen.view(), list.edges.span(), boxes_.span()});
  trees.edges.build(boxes_.span(), list.edges.span());
  boxes_.resize(list.triangles.size());
  parallel_for(boxes_.size(), detail::BoxTriangles{s, seen.view(), list.triangles.span(), boxes_.span()});
  trees.triangles.build(boxes_.span(), list.triangles.span());
  if (!vertices) return;
  boxes_.resize(list.vertices.size());
  parallel_for(boxes_.size(), detail::BoxVertices{s, seen.view(), list.vertices.span(), boxes_.span()});
  trees.vertices.build(boxes_.span(), list.vertices.span());
}

/// Looks at everything from where it is.
inline void ContactSearch::look(const PathView& paths, Real margin) {
  const detail::SurfaceView s = surface_.view();
  frame_origin_.resize(s.lead.size);
  parallel_for(s.lead.size, detail::StoreFrames{s, paths, surface_.home.span(), frame_origin_.span()});
  find_frames(paths);
  const auto trust = [&](Seen& seen, const detail::Primitives& list, Span<const FramePath> frames) {
    const Span<const int> vertices = list.vertices.span();
    parallel_for(vertices.size, detail::MakeTrust{{s, paths, frames}, margin, vertices, seen.trust.span()});
    make_shapes(list, seen);
  };
  resize(own_);
  trust(own_, surface_.followers, frames_.span());
  plant(surface_.followers, own_, false, own_trees_);
  if (surface_.alone) {
    world_ = {}, rest_trees_ = {}, outside_trees_ = {}, follower_trees_ = {};
    return;
  }
  resize(world_);
  parallel_for(surface_.everything.vertices.size(),
               detail::MakeTrust{{s, paths, {}}, margin, surface_.everything.vertices.span(), world_.trust.span()});
  find_company();
  make_shapes(looked_at_, world_);
  plant(in_company_.rest, world_, false, rest_trees_);
  plant(in_company_.outside, world_, false, outside_trees_);
  plant(in_company_.followers, world_, false, follower_trees_);
}

/// Lists what may touch another object from the world's view.
inline void ContactSearch::find_company() {
  const detail::SurfaceView s = surface_.view();
  const detail::Sight sight = world_.view();
  object_boxes_.resize(s.objects), partner_count_.resize(s.objects), partners_.resize(s.objects * s.objects);
  const Span<const int> first = surface_.first_vertex.span();
  parallel_for(s.objects, detail::BoxObjects{s, sight, first, object_boxes_.span()});
  parallel_for(s.objects,
               detail::FindPartners{s, first, surface_.fixed.span(), object_boxes_.span(), partners_.span(), partner_count_.span()});
  meetings_.resize(partners_.size());
  parallel_for(meetings_.size(), detail::BoxMeetings{s, sight, surface_.first_triangle.span(), partners_.span(), partner_count_.span(),
                                                     object_boxes_.span(), meetings_.span()});
  const auto keep = [&](const Buffer<int>& all, Buffer<int>& out, const auto& kernel) {
    kept_.resize(all.size() + 1);
    parallel_for(kept_.size(), kernel(all.span(), kept_.span()));
    out.resize(exclusive_scan(kept_.span()));
    parallel_for(all.size(), detail::KeepFlagged<int>{all.span(), kept_.span(), out.span()});
  };
  const auto look_at = [&](detail::Part part, const Buffer<int>& all, Buffer<int>& out) {
    keep(all, out, [&](Span<const int> list, Span<int> flag) {
      return detail::FlagLookedAt{
          s, part, everywhere_, list, partner_count_.span(), surface_.has_frame.span(), surface_.touches_itself.span(), flag};
    });
  };
  look_at(detail::Part::edge, surface_.everything.edges, looked_at_.edges);
  look_at(detail::Part::triangle, surface_.everything.triangles, looked_at_.triangles);
  const auto near = [&](const detail::Primitives& all, bool awake, detail::Primitives& out) {
    const auto list = [&](detail::Part part, const Buffer<int>& from, Buffer<int>& to) {
      keep(from, to, [&](Span<const int> ids, Span<int> flag) {
        return detail::FlagNear{
            s, sight, part, awake, everywhere_, ids, partner_count_.span(), meetings_.span(), surface_.touches_itself.span(), flag};
      });
    };
    list(detail::Part::vertex, all.vertices, out.vertices);
    list(detail::Part::edge, all.edges, out.edges);
    list(detail::Part::triangle, all.triangles, out.triangles);
  };
  near(surface_.everything, true, in_company_.asking);
  near(surface_.rest, false, in_company_.rest);
  near(surface_.outside, false, in_company_.outside);
  near(surface_.all_followers, false, in_company_.followers);
}

/// After a look: calls f with what asks for pairs of vertices, of what sleeps and of edges, and how many each finds.
template <class F>
void ContactSearch::query(const F& f) {
  const auto trees = [&](BoxTree Planted::*kind) {
    return detail::Trees{(own_trees_.*kind).view(), (asleep_trees_.*kind).view(), (rest_trees_.*kind).view(), (outside_trees_.*kind).view(),
                         (follower_trees_.*kind).view()};
  };
  const detail::Primitives& seen = in_view();
  const detail::Nearness nearness{surface_.view(), own_.view(), world_.view()};
  const detail::VertexQuery vertices{nearness, trees(&Planted::triangles), seen.vertices.span()};
  const detail::SleeperQuery sleepers{nearness, asleep_trees_.vertices.view(), surface_.followers.triangles.span()};
  const detail::EdgeQuery edges{nearness, trees(&Planted::edges), seen.edges.span()};
  const long long of_vertices = vertex_hits_.count(vertices.list.size, vertices);
  const long long of_sleepers = sleeper_hits_.count(asleep_trees_.size > 0 ? sleepers.list.size : 0, sleepers);
  f(vertices, sleepers, edges, of_vertices, of_sleepers, edge_hits_.count(edges.list.size, edges));
}

inline bool ContactSearch::within(const PathView& paths, Real margin, int most) {
  forget();
  look(paths, margin);
  long long found = 0;
  query([&](const auto&, const auto&, const auto&, long long of_vertices, long long of_sleepers, long long of_edges) {
    found = of_vertices + of_sleepers + of_edges;
  });
  const detail::Primitives& seen = in_view();
  return found <= static_cast<long long>(most) * (seen.vertices.size() + seen.edges.size());
}

inline void ContactSearch::rebuild(const PathView& paths, Real margin) {
  look(paths, margin);
  query(
      [&](const auto& vertices, const auto& sleepers, const auto& edges, long long of_vertices, long long of_sleepers, long long of_edges) {
        TAPE_CHECK(of_vertices + of_sleepers + of_edges <= INT_MAX);
        report_.vertex_triangle = static_cast<int>(of_vertices + of_sleepers);
        report_.edge_edge = static_cast<int>(of_edges);
        Buffer<ContactPair>& all = bonded_.size() > 0 ? found_ : pairs_;
        all.resize(report_.vertex_triangle + report_.edge_edge);
        ContactPair* const pairs = all.span().data;
        vertex_hits_.emit(vertices, Span<ContactPair>{pairs, static_cast<int>(of_vertices)});
        sleeper_hits_.emit(sleepers, Span<ContactPair>{pairs + of_vertices, static_cast<int>(of_sleepers)});
        edge_hits_.emit(edges, Span<ContactPair>{pairs + report_.vertex_triangle, report_.edge_edge});
      });
  if (bonded_.size() > 0) drop_bonded();
  join_components(surface_.view());
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
  parallel_for(found_.size(), detail::KeepFlagged<ContactPair>{found_.span(), kept_.span(), pairs_.span()});
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
    report_.capped += reduce(pairs->size(), 0, kernel, Plus{});
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
