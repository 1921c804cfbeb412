#include <gtest/gtest.h>

#include <cctype>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <random>
#include <sstream>

#include "cosim/scene/mesh_file.hpp"
#include "cosim/scene/read_scene.hpp"
#include "tape/core/error.hpp"
#include "tape/model/mesh_check.hpp"
using namespace cosim;

/// Broken scenes and meshes must be refused with an InputError, or accepted; nothing else may happen.
/// TAPE_FUZZ_SECONDS=60 in the environment goes on for that long; otherwise a fixed number of mutations runs.
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

/// Runs `feed` on mutations of `seeds`: `count` of them, or as many as TAPE_FUZZ_SECONDS allows.
void fuzz(const std::vector<std::string>& seeds, int count, const std::function<void(const std::string& text, std::size_t seed)>& feed) {
  const char* seconds = std::getenv("TAPE_FUZZ_SECONDS");
  const auto start = std::chrono::steady_clock::now();
  const auto more = [&](int i) {
    return seconds ? std::chrono::steady_clock::now() - start < std::chrono::duration<double>(std::atof(seconds)) : i < count;
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
}  // namespace

TEST(Fuzz, BrokenScenesAreRefusedInWords) {
  std::vector<std::string> seeds;
  const fs::path folder = fs::path(TAPE_SOURCE_DIR) / "data" / "scenes";
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".yaml") seeds.push_back(read_whole_file(entry.path(), "test"));
  std::sort(seeds.begin(), seeds.end());
  fuzz(seeds, 1500, [&](const std::string& text, std::size_t) {
    const SceneFile file = SceneFile::parse(text, folder / "fuzz.yaml");
    read_scene(file);
    file.require_all_used();
  });
}

TEST(Fuzz, BrokenOverridesAreRefusedInWords) {
  const fs::path scene = fs::path(TAPE_SOURCE_DIR) / "data" / "scenes" / "demo.yaml";
  const std::string text = read_whole_file(scene, "test");
  const std::vector<std::string> seeds{"strip.length=0.2", "bodies.drum.waypoints.0.time=3", "script.2.by=[0, 0, 1]",
                                       "film={from: vinyl_19mm, poisson: 0}"};
  fuzz(seeds, 400, [&](const std::string& change, std::size_t) { read_scene(SceneFile::parse(text, scene, {change})); });
}

TEST(Fuzz, BrokenMeshesAreRefusedInWords) {
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
  fuzz({stl, obj, binary, dae}, 400,
       [&](const std::string& bytes, std::size_t seed) { check_mesh(parse_mesh(bytes, formats[seed], 1, "body t"), "body t", true); });
}
