#include "cosim/run/state_file.hpp"

#include <algorithm>
#include <sstream>

#include "tape/core/error.hpp"
#include "tape/step/engagement.hpp"

namespace cosim {
namespace {
constexpr const char* kFormat = "tape states 8";

constexpr const char* kAbout =
    "SI units: m, s, kg, N, N m, rad. x: positions of the strips' vertices in the world. pose: of each body's frame B in the world, the "
    "rotation "
    "R_WB row by row, then the position. local: vertices of bodies in B. contact_force: N at each vertex. engagement: what adhesion is "
    "left, 0 to 1. "
    "part: 0 free tape, 1 collar, 2 cluster, 3 asleep. robots/NAME/: position, velocity, command, effort of each joint in the order of "
    "attribute "
    "joints.NAME (rad, m, "
    "N m, N); links: of each link's frame in the world, in the order of attribute links.NAME, the position, then the quaternion w x y z; "
    "attribute frames.NAME: named frames that are fixed in links, one a line: link, pose in it likewise, name; wrench: of the "
    "tape side on each link, force, then torque about the link's origin, in world axes, mean over the step, NaN of a base that is fixed. "
    "time: s at the end of step. "
    "mesh: how often strips had been cut; after the k-th cut the arrays of vertices and triangles go on in meshK/. grip_force: of each "
    "grip in the order of attribute grips, on what it holds, at the end "
    "of the step. phase: of the step, counted from 0 in attribute phases; -1: none.";

/// Where the arrays stand of what a strip has become after k cuts.
std::string mesh_folder(int k) { return k == 0 ? "" : "mesh" + std::to_string(k) + "/"; }

/// Matrices of equal size, one after the other.
template <class T, class M>
std::vector<T> flat(const std::vector<M>& matrices) {
  std::vector<T> out;
  for (const M& m : matrices) out.insert(out.end(), m.data(), m.data() + m.size());
  return out;
}
template <class M, class T>
std::vector<M> unflat(const std::vector<T>& values) {
  std::vector<M> out(values.size() / static_cast<std::size_t>(M::SizeAtCompileTime));
  std::size_t at = 0;
  for (M& m : out)
    for (Eigen::Index c = 0; c < m.size(); ++c) m.data()[c] = values[at++];
  return out;
}

std::string lines(const std::vector<RecordedObject>& objects, std::string RecordedObject::*member) {
  std::string text;
  for (const RecordedObject& object : objects) text += object.*member + '\n';
  return text;
}

/// One a line: index of the link, position, quaternion w x y z, name.
std::string frame_lines(const std::vector<robot::Frame>& frames) {
  std::ostringstream text;
  text.precision(17);
  for (const robot::Frame& frame : frames) {
    const Eigen::Quaterniond q(frame.X_LF.linear());
    text << frame.link << ' ' << frame.X_LF.translation().transpose() << ' ' << q.w() << ' ' << q.vec().transpose() << ' ' << frame.name
         << '\n';
  }
  return text.str();
}

std::vector<std::string> split(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> out;
  for (std::string line; std::getline(stream, line);) out.push_back(line);
  return out;
}
/// @throws InputError where a line is damaged
std::vector<robot::Frame> read_frames(const std::string& text, std::size_t links, const std::string& file) {
  std::vector<robot::Frame> frames;
  for (const std::string& line : split(text)) {
    std::istringstream stream(line);
    robot::Frame frame;
    Vec3 p, v;
    Real w = 0;
    stream >> frame.link >> p.x() >> p.y() >> p.z() >> w >> v.x() >> v.y() >> v.z() >> std::ws;
    if (!std::getline(stream, frame.name) || frame.link < 0 || static_cast<std::size_t>(frame.link) >= links)
      throw InputError(file + ": damaged: \"" + line + "\" is no frame of a robot");
    frame.X_LF.linear() = Eigen::Quaterniond(w, v.x(), v.y(), v.z()).normalized().toRotationMatrix();
    frame.X_LF.translation() = p;
    frames.push_back(frame);
  }
  return frames;
}
std::string joined_lines(const std::vector<std::string>& all) {
  std::string text;
  for (const std::string& line : all) text += line + '\n';
  return text;
}

std::vector<RecordedObject> read_objects(const Hdf5Reader& file, const std::string& folder) {
  const std::vector<int> numbers = file.read_ints(folder + "objects");
  const std::vector<double> film = file.read_reals("film");
  std::istringstream names(file.read_text("names")), materials(file.read_text("materials"));
  std::vector<RecordedObject> objects(numbers.size() / 3);
  if (film.size() != 2 * objects.size()) return {};
  for (std::size_t i = 0; i < objects.size(); ++i) {
    RecordedObject& object = objects[i];
    std::getline(names, object.name);
    std::getline(materials, object.material);
    object.first_triangle = numbers[3 * i];
    object.triangles = numbers[3 * i + 1];
    object.strip = numbers[3 * i + 2] != 0;
    object.stretch = film.at(2 * i), object.poisson = film.at(2 * i + 1);
  }
  return objects;
}

int body_count(const RecordedMesh& mesh) {
  return static_cast<int>(std::count_if(mesh.objects.begin(), mesh.objects.end(), [](const RecordedObject& o) { return !o.strip; }));
}

/// What a picture relies on.
bool consistent(const RecordedMesh& mesh) {
  const auto nv = static_cast<int>(mesh.body.size());
  bool ok = mesh.rest.size() == mesh.body.size() && mesh.local.size() == mesh.body.size() && mesh.strip_vertices >= 0 &&
            mesh.strip_vertices <= nv;
  for (int v = 0; v < nv && ok; ++v) {
    const int body = mesh.body[static_cast<std::size_t>(v)];
    ok = v < mesh.strip_vertices ? body == -1 : body >= 0 && body < body_count(mesh);
  }
  for (const Index3& t : mesh.triangles) ok = ok && t.minCoeff() >= 0 && t.maxCoeff() < nv;
  for (const RecordedObject& o : mesh.objects)
    ok = ok && o.first_triangle >= 0 && o.triangles >= 0 && o.triangles <= std::ssize(mesh.triangles) - o.first_triangle;
  return ok;
}
bool consistent(const RecordedFrame& frame, const RecordedMesh& mesh) {
  const auto finite = [](const auto& value) { return value.allFinite(); };
  const auto known = [](TapePart part) { return part >= TapePart::free && part <= TapePart::asleep; };
  return std::ssize(frame.x) == mesh.strip_vertices && std::ssize(frame.bodies) == body_count(mesh) &&
         frame.contact_force.size() == mesh.body.size() && frame.engagement.size() == frame.x.size() &&
         frame.part.size() == frame.x.size() && frame.grip_force.size() == mesh.grips.size() && frame.phase >= -1 &&
         frame.phase < std::ssize(mesh.phases) && std::all_of(frame.part.begin(), frame.part.end(), known) &&
         std::all_of(frame.x.begin(), frame.x.end(), finite) &&
         std::all_of(frame.bodies.begin(), frame.bodies.end(), [&](const Pose& X) { return finite(X.rotation) && finite(X.position); });
}
}  // namespace

RecordedMesh RecordedMesh::of(const World& world, const RobotScene& robots, const std::vector<Phase>& phases, std::string pictures,
                              std::string settings) {
  const Assembly& a = world.assembly;
  const Scene& scene = world.setup.scene;
  const auto nv = static_cast<std::size_t>(a.surface_vertices);
  RecordedMesh mesh{.scene = scene.name,
                    .objects = {},
                    .triangles = a.triangles,
                    .rest = {},
                    .body = {},
                    .local = {},
                    .pictures = std::move(pictures),
                    .robots = {},
                    .settings = std::move(settings),
                    .grips = {},
                    .phases = {}};
  for (const Grip& grip : scene.grips) mesh.grips.push_back(grip.name);
  for (const Phase& phase : phases) mesh.phases.push_back(phase.name);
  for (const RobotPart& part : robots.robots) {
    RecordedRobot& robot = mesh.robots.emplace_back(RecordedRobot{part.name, {}, {}, part.model->frames});
    for (const robot::Joint& joint : part.model->joints) robot.joints.push_back(joint.name);
    for (const robot::Link& link : part.model->links) robot.links.push_back(link.name);
  }
  const auto material = [&](int m) { return scene.materials[static_cast<std::size_t>(m)].name; };
  for (std::size_t s = 0; s < a.strips.size(); ++s) {
    const Film& film = scene.films[static_cast<std::size_t>(scene.strips[s].film)];
    const Real stretch = film.membrane_modulus * film.thickness / (1 - film.poisson * film.poisson);
    mesh.objects.push_back({scene.strips[s].name, material(scene.strips[s].material), a.strips[s].first_triangle, a.strips[s].triangles,
                            true, stretch, film.poisson});
    mesh.strip_vertices += a.strips[s].vertices;
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    mesh.objects.push_back(
        {scene.bodies[b].name, material(scene.bodies[b].material), a.bodies[b].first_triangle, a.bodies[b].triangles, false});
  mesh.rest.assign(a.rest.begin(), a.rest.begin() + std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(nv), std::ssize(a.rest)));
  mesh.rest.resize(nv, Vec2::Zero());
  mesh.local.assign(a.local.begin(), a.local.begin() + std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(nv), std::ssize(a.local)));
  mesh.local.resize(nv, Vec3::Zero());
  mesh.body.assign(nv, -1);
  for (std::size_t b = 0; b < a.bodies.size(); ++b)
    for (int v = a.bodies[b].first_vertex; v < a.bodies[b].first_vertex + a.bodies[b].vertices; ++v)
      mesh.body[static_cast<std::size_t>(v)] = static_cast<int>(b);
  return mesh;
}

RecordedFrame RecordedFrame::of(const World& world, const State& state, StepRecord step) {
  RecordedFrame frame{.mesh = 0,
                      .step = state.step,
                      .time = state.time,
                      .x = state.x,
                      .bodies = {},
                      .contact_force = std::move(step.contact_force),
                      .engagement = vertex_engagement(world, state),
                      .part = tape_parts(world, state),
                      .robots = std::move(step.robots),
                      .grip_force = std::move(step.grip_force),
                      .phase = step.phase};
  for (int b = 0; b < world.first_cluster(); ++b) frame.bodies.push_back(state.bodies[static_cast<std::size_t>(b)].pose);
  frame.contact_force.resize(static_cast<std::size_t>(world.assembly.surface_vertices), 0);
  frame.grip_force.resize(world.setup.scene.grips.size(), Vec3::Zero());
  return frame;
}

std::vector<Vec3> vertex_positions(const RecordedMesh& mesh, const RecordedFrame& frame) {
  std::vector<Vec3> x = frame.x;
  for (std::size_t v = x.size(); v < mesh.body.size(); ++v)
    x.push_back(apply(frame.bodies[static_cast<std::size_t>(mesh.body[v])], mesh.local[v]));
  return x;
}

StateWriter::StateWriter(const std::filesystem::path& name, const RecordedMesh& mesh) : file_(name) {
  file_.write_text("format", kFormat);
  file_.write_text("scene", mesh.scene);
  file_.write_text("pictures", mesh.pictures);
  file_.write_text("about", kAbout);
  file_.write_text("settings", mesh.settings);
  file_.write_text("grips", joined_lines(mesh.grips));
  file_.write_text("phases", joined_lines(mesh.phases));
  for (const RecordedRobot& robot : mesh.robots) {
    robots_.push_back(robot.name);
    file_.write_text("joints." + robot.name, joined_lines(robot.joints));
    file_.write_text("links." + robot.name, joined_lines(robot.links));
    file_.write_text("frames." + robot.name, frame_lines(robot.frames));
  }
  file_.write_text("robots", joined_lines(robots_));
  file_.write_text("names", lines(mesh.objects, &RecordedObject::name));
  file_.write_text("materials", lines(mesh.objects, &RecordedObject::material));
  std::vector<double> film;
  for (const RecordedObject& o : mesh.objects) film.insert(film.end(), {o.stretch, o.poisson});
  file_.write("film", film, {mesh.objects.size(), 2});
  write_mesh(mesh);
}

void StateWriter::write_mesh(const RecordedMesh& mesh) {
  const std::string folder = mesh_folder(mesh_);
  std::vector<int> objects;
  for (const RecordedObject& o : mesh.objects) objects.insert(objects.end(), {o.first_triangle, o.triangles, o.strip ? 1 : 0});
  const auto nv = static_cast<hsize_t>(mesh.body.size());
  file_.write(folder + "objects", objects, {mesh.objects.size(), 3});
  file_.write(folder + "triangles", flat<int>(mesh.triangles), {mesh.triangles.size(), 3});
  file_.write(folder + "rest", flat<double>(mesh.rest), {nv, 2});
  file_.write(folder + "body", mesh.body, {nv});
  file_.write(folder + "local", flat<double>(mesh.local), {nv, 3});
  file_.write(folder + "strip_vertices", std::vector<int>{mesh.strip_vertices}, {1});
}

void StateWriter::start_mesh(const RecordedMesh& mesh) {
  ++mesh_;
  write_mesh(mesh);
}

void StateWriter::add(const RecordedFrame& frame) {
  std::vector<double> poses;
  for (const Pose& X : frame.bodies) {
    const Mat3 rows = X.rotation.transpose();  // column-major storage of the transpose: row by row
    poses.insert(poses.end(), rows.data(), rows.data() + 9);
    poses.insert(poses.end(), X.position.data(), X.position.data() + 3);
  }
  const std::string folder = mesh_folder(mesh_);
  file_.append("mesh", std::vector<int>{mesh_}, {1});
  file_.append("step", std::vector<int>{frame.step}, {1});
  file_.append("time", std::vector<double>{frame.time}, {1});
  file_.append("phase", std::vector<int>{frame.phase}, {1});
  if (!frame.grip_force.empty()) file_.append("grip_force", flat<double>(frame.grip_force), {frame.grip_force.size(), 3});
  if (!frame.x.empty()) file_.append(folder + "x", flat<double>(frame.x), {frame.x.size(), 3});
  if (!poses.empty()) file_.append("pose", poses, {frame.bodies.size(), 12});
  const auto append = [&](const char* name, const std::vector<Real>& values) {
    file_.append(folder + name, std::vector<float>(values.begin(), values.end()), {values.size()});
  };
  append("contact_force", frame.contact_force);
  if (!frame.x.empty()) {
    append("engagement", frame.engagement);
    std::vector<int> parts;
    for (TapePart part : frame.part) parts.push_back(static_cast<int>(part));
    file_.append(folder + "part", parts, {parts.size()});
  }
  for (std::size_t r = 0; r < frame.robots.size(); ++r) add_robot("robots/" + robots_[r] + "/", frame.robots[r]);
  file_.reserve();
}

void StateWriter::add_robot(const std::string& folder, const RobotRecord& robot) {
  const auto append = [&](const char* name, const robot::VecX& values) {
    if (values.size() > 0)
      file_.append(folder + name, std::vector<double>(values.begin(), values.end()), {static_cast<hsize_t>(values.size())});
  };
  append("position", robot.position), append("velocity", robot.velocity), append("command", robot.command), append("effort", robot.effort);
  std::vector<double> poses, wrenches;
  for (const robot::Pose& X : robot.links) {
    const Eigen::Quaterniond q(X.linear());
    poses.insert(poses.end(), {X.translation().x(), X.translation().y(), X.translation().z(), q.w(), q.x(), q.y(), q.z()});
  }
  for (const auto& wrench : robot.wrench) wrenches.insert(wrenches.end(), wrench.begin(), wrench.end());
  file_.append(folder + "links", poses, {robot.links.size(), 7});
  file_.append(folder + "wrench", wrenches, {robot.wrench.size(), 6});
}

StateReader::StateReader(const std::filesystem::path& name) : name_(name.string()), file_(name) {
  if (file_.read_text("format") != kFormat) throw InputError(name_ + ": not a recording of this version");
  mesh_of_ = file_.read_ints("mesh");
  frames_ = static_cast<int>(mesh_of_.size());
  const bool ascend = std::ranges::is_sorted(mesh_of_) && (mesh_of_.empty() || mesh_of_[0] == 0);
  if (!ascend || file_.shape("step")[0] != mesh_of_.size()) throw InputError(name_ + ": damaged: its meshes are out of order");
  for (int k = 0; k <= (mesh_of_.empty() ? 0 : mesh_of_.back()); ++k) read_mesh();
}

void StateReader::read_mesh() {
  const std::string folder = mesh_folder(meshes());
  RecordedMesh mesh;
  mesh.scene = file_.read_text("scene");
  mesh.pictures = file_.read_text("pictures");
  mesh.settings = file_.read_text("settings");
  mesh.grips = split(file_.read_text("grips"));
  mesh.phases = split(file_.read_text("phases"));
  for (const std::string& robot : split(file_.read_text("robots"))) {
    const std::vector<std::string> links = split(file_.read_text("links." + robot));
    mesh.robots.push_back(
        {robot, split(file_.read_text("joints." + robot)), links, read_frames(file_.read_text("frames." + robot), links.size(), name_)});
  }
  mesh.objects = read_objects(file_, folder);
  mesh.triangles = unflat<Index3>(file_.read_ints(folder + "triangles"));
  mesh.rest = unflat<Vec2>(file_.read_reals(folder + "rest"));
  mesh.local = unflat<Vec3>(file_.read_reals(folder + "local"));
  mesh.body = file_.read_ints(folder + "body");
  const std::vector<int> strip_vertices = file_.read_ints(folder + "strip_vertices");
  mesh.strip_vertices = strip_vertices.empty() ? -1 : strip_vertices[0];
  if (!consistent(mesh) || (!meshes_.empty() && body_count(mesh) != body_count(meshes_[0])))
    throw InputError(name_ + ": damaged: its arrays do not fit together");
  meshes_.push_back(std::move(mesh));
}

RobotRecord StateReader::robot_at(const RecordedRobot& robot, int i) const {
  const std::string folder = "robots/" + robot.name + "/";
  const auto row = [&](const std::string& name) {
    const std::vector<double> values = file_.read_row(folder + name, i);
    return robot::VecX(Eigen::Map<const robot::VecX>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  RobotRecord record;
  if (!robot.joints.empty())
    record.position = row("position"), record.velocity = row("velocity"), record.command = row("command"), record.effort = row("effort");
  const std::vector<double> poses = file_.read_row(folder + "links", i), wrenches = file_.read_row(folder + "wrench", i);
  if (record.position.size() != std::ssize(robot.joints) || poses.size() != 7 * robot.links.size() ||
      wrenches.size() != 6 * robot.links.size())
    throw InputError(name_ + ": damaged: robot " + robot.name + " has other joints or links than it says");
  for (std::size_t l = 0; l < robot.links.size(); ++l) {
    const double* p = poses.data() + 7 * l;
    robot::Pose X = robot::Pose::Identity();
    X.linear() = Eigen::Quaterniond(p[3], p[4], p[5], p[6]).toRotationMatrix();
    X.translation() = Vec3(p[0], p[1], p[2]);
    record.links.push_back(X);
    record.wrench.emplace_back(Eigen::Map<const Eigen::Matrix<double, 6, 1>>(wrenches.data() + 6 * l));
  }
  return record;
}

RecordedFrame StateReader::frame(int i) const {
  RecordedFrame frame;
  frame.mesh = mesh_of_[static_cast<std::size_t>(i)];
  frame.step = static_cast<int>(file_.read_row("step", i)[0]);
  frame.time = file_.read_row("time", i)[0];
  frame.phase = static_cast<int>(file_.read_row("phase", i)[0]);
  const RecordedMesh& of = mesh(frame.mesh);
  if (!of.grips.empty()) frame.grip_force = unflat<Vec3>(file_.read_row("grip_force", i));
  const std::string folder = mesh_folder(frame.mesh);
  const int row = i - static_cast<int>(std::ranges::lower_bound(mesh_of_, frame.mesh) - mesh_of_.begin());
  for (const RecordedRobot& robot : of.robots) frame.robots.push_back(robot_at(robot, i));
  if (of.strip_vertices > 0) {
    frame.x = unflat<Vec3>(file_.read_row(folder + "x", row));
    frame.engagement = file_.read_row(folder + "engagement", row);
    for (Real part : file_.read_row(folder + "part", row)) frame.part.push_back(static_cast<TapePart>(static_cast<int>(part)));
  }
  const std::vector<double> poses = body_count(of) > 0 ? file_.read_row("pose", i) : std::vector<double>();
  for (std::size_t p = 0; p + 12 <= poses.size(); p += 12) {
    Pose X;
    X.rotation = Eigen::Map<const Mat3>(poses.data() + p).transpose();
    X.position = Eigen::Map<const Vec3>(poses.data() + p + 9);
    frame.bodies.push_back(X);
  }
  frame.contact_force = file_.read_row(folder + "contact_force", row);
  if (!consistent(frame, of)) throw InputError(name_ + ": damaged: its state " + std::to_string(i) + " does not fit its mesh");
  return frame;
}
}  // namespace cosim
