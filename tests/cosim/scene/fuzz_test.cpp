#include <gtest/gtest.h>

#include <cctype>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>

#include <unistd.h>

#include "cosim/exchange/exchange.hpp"
#include "cosim/run/read_run.hpp"
#include "cosim/run/state_file.hpp"
#include "cosim/scene/mesh_file.hpp"
#include "tape/core/error.hpp"
#include "tape/model/mesh_check.hpp"
#include "tape/model/strip_mesh.hpp"
#include "tape/step/stepper.hpp"
using namespace cosim;

/// Broken scenes, meshes and recordings must be refused with an InputError, or accepted; nothing else may happen.
/// LongFuzz, with four tests of 30 s each, is the same for longer.
namespace {
namespace fs = std::filesystem;

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : generator_(seed) {}
  std::size_t below(std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(generator_() % n); }
  char byte() { return static_cast<char>(below(256)); }

  /// One to four changes: a byte, a cut, a repeated piece, a token where a word stood.
  std::string operator()(std::string text) {
    for (std::size_t changes = 1 + below(4); changes > 0 && !text.empty(); --changes) {
      const std::size_t at = below(text.size()), length = std::min(text.size() - at, 1 + below(40));
      switch (below(6)) {
        case 0:
          text[at] = byte();
          break;
        case 1:
          text.erase(at, length);
          break;
        case 2:
          text.insert(below(text.size()), text.substr(at, length));
          break;
        case 3:
          text.resize(at);
          break;
        default:
          replace_word(text, at);
      }
    }
    return text;
  }

 private:
  void replace_word(std::string& text, std::size_t at) {
    static const char* kTokens[] = {"0",  "-1",   "1e300",     "1e-300", "nan",     ".inf",  "999999999999", "2147483648", "0.5",
                                    "[]", "{}",   "[1, 2, 3]", "~",      "&a",      "*a",    "? ",           ": ",         "- ",
                                    "\n", "\t",   "\"",        "'",      "#",       "!!str", "---",          "...",        "|",
                                    ">",  "true", "box",       "sphere", "dynamic", "<<",    "tape",         "mesh"};
    const auto is_word = [&](std::size_t i) {
      return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) || text[i] == '.');
    };
    std::size_t end = at;
    while (is_word(end)) ++end;
    while (at > 0 && is_word(at - 1)) --at;
    text.replace(at, end - at, kTokens[below(std::size(kTokens))]);
  }
  std::mt19937_64 generator_;
};

/// How long a test goes on: a number of mutations, or a time.
struct Length {
  int mutations = 0;
  double seconds = 0;
};
constexpr Length kLong{.seconds = 30};

/// Runs `feed` on mutations of `seeds`.
void fuzz(const std::vector<std::string>& seeds, Length length,
          const std::function<void(const std::string& text, std::size_t seed)>& feed) {
  const auto start = std::chrono::steady_clock::now();
  const auto more = [&](int i) {
    return i < length.mutations || std::chrono::steady_clock::now() - start < std::chrono::duration<double>(length.seconds);
  };
  Mutator mutate(20240607);
  int accepted = 0, refused = 0;
  for (int i = 0; more(i); ++i) {
    const std::size_t seed = mutate.below(seeds.size());
    const std::string text = mutate(seeds[seed]);
    try {
      feed(text, seed);
      ++accepted;
    } catch (const tape::InputError& e) {
      ++refused;
      ASSERT_NE(std::string(e.what()), "");
    } catch (const std::exception& e) {
      FAIL() << "mutation " << i << " throws something else: " << e.what() << "\n" << text;
    }
  }
  EXPECT_GT(accepted, 0);
  EXPECT_GT(refused, 0);
  testing::Test::RecordProperty("accepted", accepted);
  testing::Test::RecordProperty("refused", refused);
}

Real triangle_count(const tape::Scene& scene) {
  Real count = 0;
  for (const tape::Strip& strip : scene.strips) {
    const Real cells = strip.mesh.length / tape::cell_length(strip.mesh, scene.films[static_cast<std::size_t>(strip.film)].width);
    count += 4 * cells * strip.mesh.cells_across;
  }
  for (const tape::Body& body : scene.bodies) count += static_cast<Real>(body.mesh.triangles.size());
  return count;
}

/// What `tapesim run` does with a scene, up to its first step. A step may fail, in words, and then leaves the state as it was.
void simulate_one_step(SceneFile file) {
  RunInput input = read_run(std::move(file));
  if (triangle_count(input.setup.scene) > 2e4) return;  // sound, but too slow here
  input.setup.newton.max_newton = 3;
  input.setup.newton.retries = 1;
  const tape::World world = tape::World::build(input.setup);
  tape::State state = tape::State::start(world);
  const std::string before = state.hash();
  const tape::StepReport report = make_stepper(tape::Backend::cpu, world, input.robots)->step(state);
  EXPECT_EQ(report.ok, report.failure.empty());
  if (!report.ok) {
    EXPECT_EQ(state.hash(), before) << report.failure;
  }
  for (const Vec3& x : state.x) ASSERT_TRUE(x.allFinite());
  for (const tape::BodyState& body : state.bodies) ASSERT_TRUE(body.pose.position.allFinite() && body.pose.rotation.allFinite());
}

void fuzz_scenes(Length length) {
  std::vector<std::string> seeds;
  const fs::path folder = fs::path(TAPE_SOURCE_DIR) / "data" / "scenes";
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".yaml") seeds.push_back(read_whole_file(entry.path(), "test"));
  std::sort(seeds.begin(), seeds.end());
  fuzz(seeds, length, [&](const std::string& text, std::size_t) { simulate_one_step(SceneFile::parse(text, folder / "fuzz.yaml")); });
}

void fuzz_overrides(Length length) {
  const fs::path scene = fs::path(TAPE_SOURCE_DIR) / "data" / "scenes" / "drape.yaml";
  const std::string text = read_whole_file(scene, "test");
  const std::vector<std::string> seeds{"strip.length=0.05",
                                       "bodies.drum.position=[0, 0, -0.01]",
                                       "bodies.drum.motion=dynamic",
                                       "film={from: vinyl_19mm, poisson: 0}",
                                       "strip.cells_across=3",
                                       "strip.cell_length=0.004",
                                       "time.dt=0.02",
                                       "contact.dhat=2e-4",
                                       "contact.kappa=1e5",
                                       "solver.velocity_tol=1e-3",
                                       "solver.linear=cholesky",
                                       "solver.hessian=exact",
                                       "solver.stop=work",
                                       "seed=7"};
  fuzz(seeds, length, [&](const std::string& change, std::size_t) { simulate_one_step(SceneFile::parse(text, scene, {change})); });
}

void fuzz_meshes(Length length) {
  std::string stl = "solid t\n";
  for (const char* corners : {"0 0 0 0 2 0 1 0 0", "0 0 0 1 0 0 0 0 3", "0 0 0 0 0 3 0 2 0", "1 0 0 0 2 0 0 0 3"}) {
    std::istringstream stream(corners);
    stl += "facet normal 0 0 0\nouter loop\n";
    for (std::string x, y, z; stream >> x >> y >> z;) stl += "vertex " + x + " " + y + " " + z + "\n";
    stl += "endloop\nendfacet\n";
  }
  stl += "endsolid t\n";
  const std::string obj = "o t\nv 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nvn 0 0 1\nf 1//1 3//1 2//1\nf 1 2 4\nf 1 4 3\nf 2 3 4\nusemtl a\n";
  std::string binary(84 + 4 * 50, '\0');
  binary[80] = 4;
  for (int t = 0; t < 4; ++t)
    for (int k = 0; k < 9; ++k) {
      const float x = static_cast<float>((t * 7 + k * k * 3) % 11);
      std::memcpy(&binary[84 + 50 * t + 12 + 4 * k], &x, 4);
    }
  const std::string dae = R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g" name="g"><mesh><source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 2 0 0 0 3</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="4">
<input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s" name="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  const char* formats[] = {"stl", "obj", "stl", "dae"};
  fuzz({stl, obj, binary, dae}, length,
       [&](const std::string& bytes, std::size_t seed) { check_mesh(parse_mesh(bytes, formats[seed], 1, "body t"), "body t", true); });
}

/// Mutations of a recording: read as pictures of it are.
void fuzz_recordings(Length length) {
  const fs::path folder = fs::temp_directory_path() / ("tape_fuzz_test_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const tape::World world =
      tape::World::build(read_run(SceneFile::load(fs::path(TAPE_SOURCE_DIR) / "data" / "scenes" / "drape.yaml")).setup);
  {
    StateWriter writer(folder / "state.h5", RecordedMesh::of(world, {}, {}, "fov: 30\n", ""));
    for (int i = 0; i < 3; ++i) writer.add(RecordedFrame::of(world, tape::State::start(world), {}));
    writer.commit();
  }
  const std::string whole = read_whole_file(folder / "state.h5", "test");
  fuzz({whole.substr(0, 4096)}, length, [&](const std::string& start, std::size_t) {  // where the structure stands
    std::ofstream(folder / "fuzz.h5", std::ios::binary) << start + (start.size() == 4096 ? whole.substr(4096) : "");
    const StateReader reader(folder / "fuzz.h5");
    for (int i = 0; i < std::min(reader.frames(), 3); ++i) vertex_positions(reader.mesh(), reader.frame(i));
  });
  fs::remove_all(folder);
}
}  // namespace

TEST(Fuzz, BrokenScenesAreRefusedInWords) { fuzz_scenes({.mutations = 300}); }
TEST(Fuzz, BrokenOverridesAreRefusedInWords) { fuzz_overrides({.mutations = 100}); }
TEST(Fuzz, BrokenMeshesAreRefusedInWords) { fuzz_meshes({.mutations = 200}); }
TEST(Fuzz, BrokenRecordingsAreRefusedInWords) { fuzz_recordings({.mutations = 200}); }

TEST(LongFuzz, BrokenScenesAreRefusedInWords) { fuzz_scenes(kLong); }
TEST(LongFuzz, BrokenOverridesAreRefusedInWords) { fuzz_overrides(kLong); }
TEST(LongFuzz, BrokenMeshesAreRefusedInWords) { fuzz_meshes(kLong); }
TEST(LongFuzz, BrokenRecordingsAreRefusedInWords) { fuzz_recordings(kLong); }
