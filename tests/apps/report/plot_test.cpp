#include "apps/report/plot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tape/core/error.hpp"

using namespace tape;
using namespace tape::report;
using testing::HasSubstr;
namespace fs = std::filesystem;

namespace {
std::string read(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}
const Plot kPlot{"a study",
                 "time [s]",
                 "error",
                 {{1, 0.1, "it's coarse", true}, {10, 0.01, "fine", true}, {10, 0.2, "poor", false}, {0, 1, "cannot be shown", false}}};

class PlotFile : public testing::Test {
 protected:
  PlotFile() { fs::create_directories(folder); }
  ~PlotFile() override { fs::remove_all(folder); }
  fs::path folder = fs::temp_directory_path() / ("plot_test_" + std::to_string(getpid()));
};
}  // namespace

TEST(ParetoFront, HoldsWhatBringsTheErrorDownForItsCost) {
  EXPECT_EQ(pareto_front({1, 2, 3, 4, 2}, {4, 3, 3, 1, 5}), (std::vector<bool>{true, true, false, true, false}));
}
TEST(ParetoFront, LeavesOutASavingBelowOnePerCentAndWhatIsNotFinite) {
  const Real nan = std::nan("");
  EXPECT_EQ(pareto_front({1, 2, 3, 0.1, nan}, {1, 0.995, 0.98, nan, 0.1}), (std::vector<bool>{true, false, true, false, false}));
}
TEST_F(PlotFile, IsMadeAsPngAndSvgWithTheParetoFrontMarked) {
  write_plot(kPlot, folder / "study");
  EXPECT_EQ(read(folder / "study.png").substr(1, 3), "PNG");
  const std::string svg = read(folder / "study.svg");
  EXPECT_THAT(svg, HasSubstr("Pareto front"));
  EXPECT_THAT(svg, HasSubstr("coarse"));
  EXPECT_THAT(svg, testing::Not(HasSubstr("cannot be shown")));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 2);
}
TEST_F(PlotFile, WithoutGnuplotSaysSoAndLeavesNothing) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  try {
    write_plot(kPlot, folder / "study");
    ADD_FAILURE() << "plotted without gnuplot";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("gnuplot"));
  }
  setenv("PATH", path.c_str(), 1);
  EXPECT_TRUE(fs::is_empty(folder));
}
TEST_F(PlotFile, WithoutAnyPointToShowIsRefused) {
  EXPECT_THROW(write_plot({"none", "", "", {{0, 1, "", false}}}, folder / "study"), InputError);
}
TEST_F(PlotFile, APageHoldsCurvesWithTheirUncertainPointsAndAPlot) {
  const Curves curves{"episode 1", "time [s]", "error [px]", {{"coh-f", {{0, 1}, {1, 2, true}, {2, std::nan("")}}}, {"nothing", {}}}};
  write_page({curves, kPlot, curves}, folder / "page");
  EXPECT_EQ(read(folder / "page.png").substr(1, 3), "PNG");
  const std::string svg = read(folder / "page.svg");
  for (const char* text : {"episode 1", "coh-f", "error [px]", "a study", "Pareto front"}) EXPECT_THAT(svg, HasSubstr(text));
  EXPECT_THAT(svg, testing::Not(HasSubstr("nothing")));
}
TEST_F(PlotFile, CurvesWithoutAnyPointAreRefused) {
  EXPECT_THROW(write_page({Curves{"none", "", "", {{"coh-f", {}}}}}, folder / "page"), InputError);
}
