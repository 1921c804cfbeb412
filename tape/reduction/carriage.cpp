#include "tape/reduction/carriage.hpp"

namespace tape {
std::vector<int> next_to_free(const Cluster& cluster, const std::vector<bool>& member) {
  std::vector<int> next;
  for (std::size_t v = 0; v < member.size(); ++v)
    if ((*cluster.distance)[v] == 1 && !member[v]) next.push_back(static_cast<int>(v));
  return next;
}

Carriage carry(const Assembly& a, const std::vector<Cluster>& clusters, const Sleepers* sleepers, int collar) {
  Carriage c{.owner = a.owner, .local = a.local, .mass = a.mass, .body_mass = {}, .strips = {}, .next = {}, .blocks = a.first_strip_block};
  for (const BodyPart& body : a.bodies) c.body_mass.push_back(body.mass);
  std::size_t known = 0;
  for (std::size_t s = 0; s < a.strips.size(); ++s) {
    const StripPart& strip = a.strips[s];
    const int body = a.cluster_body(static_cast<int>(s));
    const int ride_block = strip.hub < 0 ? -1 : a.bodies[static_cast<std::size_t>(strip.hub)].block, ride = ride_block < 0 ? -1 : strip.hub;
    std::vector<bool> member(static_cast<std::size_t>(strip.vertices), false);
    if (body >= 0) {
      const Cluster& cluster = clusters[known++];
      member = members(a, strip, cluster, collar);
      c.body_mass[static_cast<std::size_t>(body)] = cluster.mass;
      c.next.push_back(next_to_free(cluster, member));
    }
    c.strips.push_back({c.blocks, 0});
    Real carried = 0;
    for (int v = 0; v < strip.vertices; ++v) {
      const auto i = static_cast<std::size_t>(strip.first_vertex + v);
      if (const int on = sleepers == nullptr ? -1 : sleepers->body[i]; on >= 0) {
        c.owner[i] = {a.bodies[static_cast<std::size_t>(on)].block, on};
        c.local[i] = sleepers->local[i];
        continue;
      }
      if (!member[static_cast<std::size_t>(v)]) {
        c.owner[i] = {c.blocks++, -1, ride, ride_block};
        continue;
      }
      const Cluster& cluster = clusters[known - 1];
      c.owner[i] = {a.bodies[static_cast<std::size_t>(body)].block, body, ride, ride_block};
      c.local[i] = (*cluster.local)[static_cast<std::size_t>(v)] - cluster.centre;
      carried += c.mass[i];
      c.mass[i] = 0;
    }
    if (body >= 0) {
      const auto centre = static_cast<std::size_t>(a.bodies[static_cast<std::size_t>(body)].centre);
      c.mass[centre] = carried;
      c.owner[centre].ride = ride, c.owner[centre].ride_block = ride_block;
    }
    c.strips.back().blocks = c.blocks - c.strips.back().block;
  }
  return c;
}
}  // namespace tape
