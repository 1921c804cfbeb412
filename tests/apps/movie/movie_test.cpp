#include "apps/movie/movie.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "apps/movie/things.hpp"
#include "apps/render/panel.hpp"
#include "tests/apps/movie/motion.hpp"

using namespace tape;
using namespace tape::movie;
using render::Picture;
using test::movie_frame, test::movie_mesh, test::movie_params;

namespace {
struct Shown {
  std::vector<Picture> pictures;
  std::vector<Movie::Still> stills;
};
/// The movie of these states, with the stage of all of them.
Shown movie_of(const PictureParams& params, const std::vector<RecordedFrame>& frames, const RecordedMesh& mesh = movie_mesh()) {
  Survey survey(params);
  for (const RecordedFrame& frame : frames) survey.add(mesh, frame);
  Shown shown;
  Movie movie(params, survey.stage(), mesh, frames[0], [&](const Picture& picture) { shown.pictures.push_back(picture); });
  for (const RecordedFrame& frame : frames) movie.add(mesh, frame);
  movie.finish();
  shown.stills = movie.stills();
  return shown;
}
/// A part of a picture, by shares of its size.
struct Region {
  Real left, top, right, bottom;
};
/// Share of the pixels of a region that differ.
Real difference(const Picture& a, const Picture& b, const Region& region) {
  EXPECT_EQ(a.rgb.size(), b.rgb.size());
  const auto x = [&](Real share) { return static_cast<int>(std::lround(share * a.width)); };
  const auto y = [&](Real share) { return static_cast<int>(std::lround(share * a.height)); };
  int differ = 0, all = 0;
  for (int j = y(region.top); j < y(region.bottom); ++j)
    for (int i = x(region.left); i < x(region.right); ++i, ++all) differ += !std::equal(a.at(i, j), a.at(i, j) + 3, b.at(i, j));
  return static_cast<Real>(differ) / all;
}
constexpr Region kWhole{0, 0, 1, 1}, kCaption{0, 0, 0.75, 0.13}, kBelowCaption{0, 0.16, 1, 1};
}  // namespace

TEST(Movie, ShowsAtEachTimeTheStateNearestToIt) {
  // Pictures at 0, 0.1, 0.2, 0.3, 0.4 s; the strip has moved at 0.14 s and at 0.31 s.
  const Shown shown =
      movie_of(movie_params(), {movie_frame(0, 0, 0.02), movie_frame(1, 0.14, 0.08), movie_frame(2, 0.31, 0.1), movie_frame(3, 0.4, 0.1)});
  ASSERT_EQ(shown.pictures.size(), 5u);
  const auto same = [&](std::size_t a, std::size_t b) { return difference(shown.pictures[a], shown.pictures[b], kBelowCaption) == 0; };
  EXPECT_FALSE(same(0, 1)) << "0.1 s is nearer to 0.14 s";
  EXPECT_TRUE(same(1, 2)) << "and so is 0.2 s";
  EXPECT_FALSE(same(2, 3));
  EXPECT_TRUE(same(3, 4)) << "it does not move any more";
}
TEST(Movie, TellsTimeAndPhaseOnItself) {
  const auto at = [](Real time, int phase) { return movie_of(movie_params(), {movie_frame(0, time, 0.05, phase)}).pictures.at(0); };
  const Picture start = at(0, -1), later = at(1.25, -1), lift = at(0, 0), hold = at(0, 1);
  for (const Picture* other : {&later, &lift, &hold}) {
    EXPECT_GT(difference(start, *other, kCaption), 0.005);
    EXPECT_EQ(difference(start, *other, kBelowCaption), 0);
  }
  EXPECT_GT(difference(lift, hold, kCaption), 0.005);
}
TEST(Movie, AnInsetStandsInItsCornerAndChangesNothingElse) {
  const RecordedFrame frame = movie_frame(0, 0, 0.05);
  const Picture without = movie_of(movie_params(), {frame}).pictures.at(0);
  const render::LookAtSettings close{.eye = {0.2, -0.1, 0.15}, .target = {0.1, 0.05, 0.05}};
  const struct {
    Corner corner;
    Region inside;
  } cases[] = {{Corner::bottom_right, {0.70, 0.70, 0.96, 0.96}},
               {Corner::top_right, {0.70, 0.04, 0.96, 0.30}},
               {Corner::bottom_left, {0.04, 0.70, 0.30, 0.96}}};
  for (const auto& c : cases) {
    PictureParams params = movie_params();
    params.cameras.push_back({close, InsetParams{c.corner, 0.3}});
    const Picture with = movie_of(params, {frame}).pictures.at(0);
    const Real changed = difference(with, without, kWhole);
    EXPECT_GT(difference(with, without, c.inside), 0.5);
    EXPECT_GT(changed, 0.5 * 0.3 * 0.3);
    EXPECT_LT(changed, 0.32 * 0.34) << "a share of 0.3 each way, and its border";
  }
}
TEST(Movie, CamerasWithoutInsetStandSideBySide) {
  PictureParams params = movie_params();
  params.cameras.push_back({render::LookAtSettings{.eye = {0.6, 0, 0.4}, .target = {0.05, 0.05, 0.03}}});
  const RecordedFrame frame = movie_frame(0, 0, 0.05);
  const Picture both = movie_of(params, {frame}).pictures.at(0);
  EXPECT_EQ(both.width, 320);
  params.cameras[1] = params.cameras[0];
  const Picture twice = movie_of(params, {frame}).pictures.at(0);
  EXPECT_EQ(difference(both, twice, {0, 0.16, 0.5, 0.7}), 0);
  EXPECT_GT(difference(both, twice, {0.5, 0, 1, 1}), 0.3);
}
TEST(Movie, MarksACutForHalfASecond) {
  std::vector<RecordedFrame> frames;
  for (int i = 0; i <= 10; ++i) frames.push_back(movie_frame(i, 0.1 * i, 0.05));
  const Shown plain = movie_of(movie_params(), frames);
  for (std::size_t i = 3; i < frames.size(); ++i) frames[i].mesh = 1;
  const Shown cut = movie_of(movie_params(), frames);
  ASSERT_EQ(plain.pictures.size(), 11u);
  for (std::size_t i = 0; i < 11; ++i) {
    const Real changed = difference(plain.pictures[i], cut.pictures[i], {0.4, 0, 0.6, 0.4});
    if (i >= 3 && i < 8)
      EXPECT_GT(changed, 0.1) << i;
    else
      EXPECT_EQ(changed, 0) << i;
  }
}
TEST(Movie, ForcesAreDrawnWhereTheyAreAskedFor) {
  PictureParams params = movie_params();
  std::vector<RecordedFrame> frames;
  for (int i = 0; i <= 10; ++i) frames.push_back(movie_frame(i, 0.1 * i, 0.05, -1, 0.5 * i));
  const Picture without = movie_of(params, frames).pictures.back();
  params.overlay = {"pull"};
  const Shown with = movie_of(params, frames);
  constexpr Region kCharts{0, 0.13, 0.6, 0.5};
  EXPECT_GT(difference(with.pictures.back(), without, kCharts), 0.3);
  EXPECT_EQ(difference(with.pictures.back(), without, {0.6, 0, 1, 1}), 0);
  EXPECT_GT(difference(with.pictures[5], with.pictures[6], kCharts), 0.01) << "figure and curve go on";
}
TEST(Movie, KeepsTheLastPictureOfEachPhase) {
  const Shown shown = movie_of(movie_params(), {movie_frame(0, 0, 0.02), movie_frame(1, 0.1, 0.03, 0), movie_frame(2, 0.2, 0.05, 0),
                                                movie_frame(3, 0.3, 0.08, 1), movie_frame(4, 0.4, 0.1, 1)});
  ASSERT_EQ(shown.stills.size(), 2u) << "none of what is before the first";
  EXPECT_EQ(shown.stills[0].phase, "lift");
  EXPECT_EQ(shown.stills[0].picture.rgb, shown.pictures[2].rgb);
  EXPECT_EQ(shown.stills[1].phase, "hold");
  EXPECT_EQ(shown.stills[1].picture.rgb, shown.pictures[4].rgb);
}
TEST(Survey, AMotionThatStaysNearItsStartKeepsItsStage) {
  const RecordedMesh mesh = movie_mesh();
  // The start is a box of 0.3 x 0.3 x 0.02 m with a diagonal of 0.425 m: 0.106 m of room on each side.
  const auto keeps = [&](Real height) {
    Survey survey(movie_params());
    survey.add(mesh, movie_frame(0, 0, 0.02));
    const Stage first = survey.stage();
    survey.add(mesh, movie_frame(1, 1, height));
    return survey.stage() == first;
  };
  EXPECT_TRUE(keeps(0.12));
  EXPECT_FALSE(keeps(0.13));
  EXPECT_FALSE(keeps(-0.01)) << "the ground lies at the lowest point";
}
TEST(Survey, ColoursOfValuesAndAnOpenCameraTakeTheWholeMotion) {
  const RecordedMesh mesh = movie_mesh();
  for (const bool open : {false, true}) {
    PictureParams params = movie_params();
    if (open)
      params.cameras.clear();
    else
      params.view.color = render::ColorBy::contact_force;
    Survey survey(params);
    survey.add(mesh, movie_frame(0, 0, 0.02));
    const Stage first = survey.stage();
    RecordedFrame next = movie_frame(1, 1, 0.03);
    next.contact_force[0] = 2;
    survey.add(mesh, next);
    EXPECT_FALSE(survey.stage() == first) << open;
  }
}

TEST(Things, AFrameThatIsFixedInALinkCarriesACameraAsTheLinkDoes) {
  RecordedMesh mesh = movie_mesh();
  mesh.robots = {{"arm", {}, {"base", "hand"}, {{"lens", 1, robot::Pose(Eigen::Translation3d(0, 0, 0.1))}}}};
  RecordedFrame frame = movie_frame(0, 0, 0);
  const robot::Pose X_WL = Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX());
  frame.robots = {{.position = {}, .velocity = {}, .command = {}, .effort = {}, .links = {robot::Pose::Identity(), X_WL}}};
  const Pose lens = frame_of("arm:lens", mesh, frame), hand = frame_of("arm:hand", mesh, frame);
  EXPECT_LT((lens.rotation - X_WL.linear()).norm(), 1e-15);
  EXPECT_LT((hand.position - Vec3(1, 2, 3)).norm(), 1e-15);
  EXPECT_LT((lens.position - Vec3(1, 2 - 0.1 * std::sin(0.5), 3 + 0.1 * std::cos(0.5))).norm(), 1e-15);
  EXPECT_THROW(frame_of("arm:elbow", mesh, frame), InputError);
}
