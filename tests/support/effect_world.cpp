#include "tests/support/effect_world.hpp"

namespace tape::test {
namespace {
template <class T>
Span<const T> span(const std::vector<T>& v) {
  return {v.data(), static_cast<int>(v.size())};
}
}  // namespace

EffectWorld::EffectWorld(unsigned seed) : generator_(seed) {
  scene.films.push_back({});
  scene.films[0].poisson = 0.3;
  scene.materials = {{"tape", 0.5}, {"rubber", 1.0}};
  add_strip();
  add_bodies();
  add_pairs();
  add_samples();
  add_grips();
  add_axles();
  disturb();
  add_seat();
}

std::vector<int> EffectWorld::add_vertices(const std::vector<Vec3>& positions) {
  std::vector<int> ids;
  for (const Vec3& p : positions) {
    ids.push_back(static_cast<int>(assembly.x.size()));
    assembly.x.push_back(p);
    assembly.rest.push_back(p.head<2>());
    assembly.mass.push_back(random(1e-6, 2e-6));
    assembly.owner.push_back({assembly.blocks++, -1});
  }
  return ids;
}

void EffectWorld::add_strip() {
  scene.strips.push_back({});
  constexpr int kRows = 5, kColumns = 4;
  constexpr Real kCell = 3e-3;
  std::vector<Vec3> flat;
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < kColumns; ++c) flat.push_back(kCell * (Vec3(r, c, 0) + 0.2 * Vec3(random(-1, 1), random(-1, 1), 0)));
  StripPart part{.film = 0, .first_vertex = 0, .first_triangle = 0, .vertices = kRows * kColumns, .triangles = 0, .columns = kColumns};
  add_vertices(flat);
  for (int r = 0; r + 1 < kRows; ++r) {
    for (int c = 0; c + 1 < kColumns; ++c) {
      const int a = r * kColumns + c, b = a + kColumns;
      if (random(0, 1) < 0.5) {
        assembly.triangles.insert(assembly.triangles.end(), {Index3(a, b, b + 1), Index3(a, b + 1, a + 1)});
      } else {
        assembly.triangles.insert(assembly.triangles.end(), {Index3(a, b, a + 1), Index3(b, b + 1, a + 1)});
      }
    }
  }
  part.triangles = static_cast<int>(assembly.triangles.size());
  assembly.strip_vertices = part.vertices;
  assembly.strips.push_back(part);
}

void EffectWorld::add_bodies() {
  for (Motion motion : {Motion::dynamic, Motion::driven}) {
    Body named;
    named.name = motion == Motion::dynamic ? "drum" : "arm";
    named.motion = motion;
    scene.bodies.push_back(named);
    BodyPart part;
    part.motion = motion;
    part.first_vertex = static_cast<int>(assembly.x.size());
    part.vertices = 4;
    part.centre = part.first_vertex;
    const Vec3 far(0, 0, 0.1);
    add_vertices({far + random_vector(0.01), far + random_vector(0.01), far + random_vector(0.01), far + random_vector(0.01)});
    assembly.local.resize(assembly.x.size(), Vec3::Zero());
    for (int v = part.first_vertex; v < part.first_vertex + 4; ++v) assembly.local[static_cast<std::size_t>(v)] = random_vector(0.5);
    part.block = assembly.blocks;
    assembly.blocks += 2;
    const Vec3 spread(random(0.3, 1), random(0.3, 1), random(0.3, 1));
    const Mat3 R = rotation_exp(random_vector(3));
    if (motion == Motion::dynamic) part.mass = {0.02, 0.02 * R * spread.cwiseProduct(spread).asDiagonal() * R.transpose()};
    assembly.bodies.push_back(part);
    body_mass.push_back(part.mass);
  }
}

void EffectWorld::add_grips() {
  const std::vector<int> anchor = add_vertices({Vec3(0, 0, 0.02)});
  scene.grips.resize(2);
  assembly.grips = {{{0, 1}, {-1, -1}, 100}, {{2}, anchor, 50}};
  grip_stiffness = {100, 0, 50};  // the second spring is open
  for (int k = 0; k < 3; ++k) grip_target.push_back(random_vector(0.01));
}

/// One with a slow drive, one that slips far behind a fast one.
void EffectWorld::add_axles() {
  for (const AxleParams& params : {AxleParams{.torque = 0.5, .speed = 0.02, .stiffness = 70}, AxleParams{.torque = 0.3, .speed = -8}}) {
    const Vec3 foot = random_vector(0.01);
    const Mat3 R = 0.01 * rotation_exp(random_vector(3));
    const auto add = [&](const Vec3& from_foot) { return add_vertices({foot + R * from_foot})[0]; };
    const Vec3 none = Vec3::Zero(), end = Vec3::UnitZ(), along = Vec3::UnitX(), across = Vec3::UnitY();
    scene.axles.push_back({.body = "drum", .to = "arm", .params = params});
    assembly.axles.push_back({{add(none), add(end)}, {add(none), add(end)}, add(along), {add(along), add(across)}, params.stiffness});
  }
}

void EffectWorld::add_pairs() {
  const Real dhat = scene.dhat();
  int interface = 1;
  const auto add = [&](PairKind kind, const Real(&p)[4][3], Real height, Real xi) {
    const Mat3 R = rotation_exp(random_vector(3));
    const Vec3 shift = random_vector(0.01);
    std::vector<Vec3> at;
    for (int k = 0; k < 4; ++k) {
      const bool first = kind == PairKind::vertex_triangle ? k == 0 : k < 2;
      at.push_back(shift + R * (2e-3 * Vec3(p[k][0], p[k][1], p[k][2]) + (first ? height : 0) * Vec3(0, 0, 1)));
    }
    const std::vector<int> v = add_vertices(at);
    const Real length4 = (at[1] - at[0]).squaredNorm() * (at[3] - at[2]).squaredNorm();
    pairs.push_back({.v = {v[0], v[1], v[2], v[3]},
                     .kind = kind,
                     .interface = interface,
                     .xi = xi,
                     .dhat = dhat,
                     .kappa = scene.contact.kappa,
                     .weight = 4e-6,
                     .mollifier = kind == PairKind::edge_edge ? 1e-3 * length4 : 0,
                     .sharing = {{2, 2, 1}, {6, 5, 0}},
                     .triangle = kind == PairKind::vertex_triangle ? static_cast<int>(pairs.size()) : -1});
  };
  for (Real xi : {0.0, 9e-5}) {
    for (Real gap : {0.02, 0.3, 0.9}) {
      interface = 3;
      add(PairKind::vertex_triangle, {{0.3, 0.3, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, xi + gap * dhat, xi);  // for bonds
      interface = 1;
      const Real h = xi + gap * dhat;
      add(PairKind::vertex_triangle, {{0.3, 0.3, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, h, xi);               // face
      add(PairKind::vertex_triangle, {{0.4, 0.02, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, h, xi);              // face, near an edge
      add(PairKind::vertex_triangle, {{0.02, 0.03, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, h, xi);             // face, near a corner
      add(PairKind::vertex_triangle, {{0.4, -1e-4, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, h, xi);             // edge
      add(PairKind::vertex_triangle, {{-1e-4, -1e-4, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, h, xi);           // point
      add(PairKind::edge_edge, {{-0.3, 0.1, 0}, {0.6, 0, 0}, {0, -0.5, 0}, {0.1, 0.5, 0}}, h, xi);           // edge-edge
      add(PairKind::edge_edge, {{-0.5, 0, 0}, {0.5, 0.02, 0}, {-0.4, -0.006, 0}, {0.6, 0.003, 0}}, h, xi);   // nearly parallel
      add(PairKind::edge_edge, {{1e-4, 0, 0}, {0.6, 0.01, 0}, {-0.5, 0, 1e-3}, {-1e-4, 0.001, 0}}, h, xi);   // end to end, nearly parallel
      add(PairKind::edge_edge, {{0.05, 1e-4, 0}, {0.1, 0.6, 0}, {-0.4, -1e-5, 0}, {0.5, -1e-5, 0}}, h, xi);  // end to edge
    }
  }
  mu = {0.5, 0.7, 0.7, 1.0};
  scene.adhesives = {{0, 1, {AdhesionLaw::per_pair, {{true, true}, {true, true}}, {.cn = 0.675, .ct = 0.5, .beta0 = 0.8}, {}, {}}},
                     {0, 0, {AdhesionLaw::per_area, {{true, true}, {true, true}}, {}, {.toughness = 5, .shear = 0.7, .reach = 1}, {}}},
                     {1, 1, {AdhesionLaw::bond, {{true, true}, {true, true}}, {}, {}, {.reach = 1, .floor = 0}}}};
  for (int a : {0, 1})
    for (int b : {0, 1}) adhesion.push_back(scene.adhesion(a, b));
}

void EffectWorld::add_samples() {
  const Real xi = 9e-5, dhat = scene.dhat();
  for (Real gap : {0.3, 0.55, 0.9}) {
    for (Real y : {5e-4, -1e-4}) {      // over the face; beside an edge
      for (int triangle : {3, 1000}) {  // of a strip; of a body
        const Mat3 R = rotation_exp(random_vector(3));
        const Vec3 shift = random_vector(0.01);
        const Vec3 point(5e-4, y, xi + gap * dhat), d0(1e-3, 0, 2e-5), d1(0, 1e-3, 0);
        std::vector<Vec3> at{point + d0, point + d1, point - 0.4 * d0 - 0.6 * d1, Vec3(0, 0, 0), Vec3(2e-3, 0, 0), Vec3(0, 2e-3, 0)};
        for (Vec3& p : at) p = shift + R * p;
        const std::vector<int> v = add_vertices(at);
        samples.push_back({.v = {v[0], v[1], v[2], v[3], v[4], v[5]},
                           .w = {0.2, 0.3, 0.5},
                           .interface = 0,
                           .xi = xi,
                           .area = 1e-6,
                           .id = {static_cast<int>(samples.size()), triangle}});
      }
    }
  }
}

void EffectWorld::disturb() {
  x = x_start = x_tilde = assembly.x;
  no_fan.assign(x.size() + 1, 0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool strip = static_cast<int>(i) < assembly.strips[0].vertices;
    if (strip) x[i] += random_vector(1e-3);
    const Real slip = i / 4 % 2 == 0 ? 2e-5 : 2e-7;  // eps_v dt = 1e-6: every other pair slides
    x_start[i] = x[i] + random_vector(slip);         // bonds are made there and strained by the way to x
    x_tilde[i] = x[i] + random_vector(1e-3);
  }
  for (std::size_t b = 0; b < assembly.bodies.size(); ++b) {
    body_target.push_back({rotation_exp(random_vector(3)), random_vector(0.01)});
    body.push_back({rotation_exp(random_vector(0.8)) * body_target[b].rotation, body_target[b].position + random_vector(1e-3)});
  }
}

/// Of the drum on the arm, at about their places.
void EffectWorld::add_seat() {
  Eigen::Matrix<Real, 6, 6> any;
  for (int k = 0; k < 36; ++k) any.data()[k] = random(-1, 1);
  Seat::Element seat{.hub = 1,
                     .cluster = 0,
                     .hub_block = assembly.bodies[1].block,
                     .cluster_block = assembly.bodies[0].block,
                     .arm = random_vector(0.02),
                     .turn = rotation_exp(random_vector(0.3)) * body[1].rotation.transpose() * body[0].rotation,
                     .form = {}};
  seat.form.energy = 1e-3;
  seat.form.force << random_vector(3), random_vector(0.1);
  const Vec3 length(1, 1, 1), angle(0.03, 0.03, 0.03);
  VecN<6> scale;
  scale << length, angle;
  seat.form.stiffness = 1e3 * scale.asDiagonal() * any * any.transpose() * scale.asDiagonal();
  seats.push_back(seat);
}

StateView EffectWorld::view() const {
  return {dt,
          false,
          span(x),
          span(x_start),
          span(x_tilde),
          span(assembly.owner),
          span(assembly.mass),
          span(body_mass),
          span(body),
          span(body_target),
          span(grip_target),
          span(grip_stiffness),
          span(mu),
          span(adhesion),
          {span(no_fan), {}}};
}
StateView EffectWorld::start_view() const {
  StateView s = view();
  s.x = s.x_start;
  return s;
}

void EffectWorld::move(const Pose& by) {
  for (std::vector<Vec3>* points : {&x, &x_start, &x_tilde, &grip_target})
    for (Vec3& p : *points) p = apply(by, p);
  for (std::vector<Pose>* poses : {&body, &body_target})
    for (Pose& p : *poses) p = {by.rotation * p.rotation, apply(by, p.position)};
}
}  // namespace tape::test
