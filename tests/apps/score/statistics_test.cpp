#include "apps/score/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace tape;
using namespace tape::score;

namespace {
void expect_interval(Interval interval, Real low, Real high, Real tolerance = 0.5e-10) {
  EXPECT_NEAR(interval.low, low, tolerance);
  EXPECT_NEAR(interval.high, high, tolerance);
}
/// True positives, false negatives, true negatives and false positives, in the order of the paper's bars.
Confusion counts(int tp, int fn, int tn, int fp) {
  return {.true_positive = tp, .false_positive = fp, .false_negative = fn, .true_negative = tn};
}
const std::vector<Real> kErrors{22.1, 17.5, 30.25, 12.0, 19.75};
}  // namespace

TEST(Statistics, WilsonIntervalsOfThePaperAgreeToTenDigits) {
  expect_interval(wilson({68, 98}), .5967555816, .7763734018);
  expect_interval(wilson({79, 98}), .7169317562, .8722192703);
  expect_interval(wilson({0, 98}), 0, .0377199901);
  expect_interval(wilson({98, 98}), .9622800099, 1);
  expect_interval(wilson({1, 1}), .2065493144, 1);
  expect_interval(wilson({9, 10}), .596, .982, 0.5e-3);  // as the lerobot project prints it
}
TEST(Statistics, WilsonIntervalsEndExactlyAtNoneAndAll) {
  EXPECT_EQ(wilson({0, 7}).low, 0);
  EXPECT_EQ(wilson({98, 98}).high, 1);
}
TEST(Statistics, NewcombeDifferencesArePublishedOnes) {  // [Newcombe 1998], table II
  const Difference a = newcombe({56, 70}, {48, 80}), b = newcombe({9, 10}, {3, 10});
  EXPECT_NEAR(a.value, 0.2, 1e-15);
  expect_interval(a.interval, .0524, .3339, 0.5e-4);
  EXPECT_NEAR(b.value, 0.6, 1e-15);
  expect_interval(b.interval, .1705, .8090, 0.5e-4);
}
TEST(Statistics, PeelAndStickHaveTheAgreementAndTheBalancedAccuracyOfThePaper) {
  const Confusion coh_f = counts(69, 0, 0, 31), coh_r = counts(65, 4, 16, 15), bond_r = counts(63, 6, 19, 12),
                  stick = counts(36, 14, 12, 9);
  EXPECT_EQ(*coh_f.balanced_accuracy(), 0.5);
  EXPECT_EQ(coh_f.agreement().value(), 0.69);
  EXPECT_EQ(coh_r.agreement().value(), 0.81);
  EXPECT_NEAR(*coh_r.balanced_accuracy(), .729, 0.5e-3);
  EXPECT_EQ(bond_r.agreement().value(), 0.82);
  EXPECT_NEAR(*bond_r.balanced_accuracy(), .763, 0.5e-3);
  EXPECT_EQ(stick.agreement().successes, 48);
  EXPECT_EQ(stick.agreement().trials, 71);
  EXPECT_NEAR(*stick.balanced_accuracy(), .646, 0.5e-3);
  EXPECT_EQ(coh_r.real().successes, 69);
  EXPECT_EQ(coh_r.simulated().successes, 80);
}
TEST(Statistics, BalancedAccuracyIsUndefinedWithoutRealSuccessesOrWithoutRealFailures) {
  EXPECT_FALSE(counts(0, 0, 5, 3).balanced_accuracy());
  EXPECT_FALSE(counts(5, 3, 0, 0).balanced_accuracy());
}
TEST(Statistics, OutcomesAreComparedCaseByCase) {
  const Confusion c = compare({true, true, false, false, true}, {true, false, true, false, false});
  EXPECT_EQ(c.true_positive, 1);
  EXPECT_EQ(c.false_positive, 2);
  EXPECT_EQ(c.false_negative, 1);
  EXPECT_EQ(c.true_negative, 1);
  EXPECT_THROW(compare({true}, {true, false}), InputError);
  EXPECT_THROW(compare({}, {}), InputError);
}
TEST(Statistics, McNemarCountsTheSplitsOfTheDisagreementsThatAreAtLeastAsUneven) {
  EXPECT_NEAR(counts(63, 6, 16, 15).mcnemar(), 2 * 82160 / 2097152.0, 1e-12);  // C(21,0) + ... + C(21,6) = 82160
  EXPECT_NEAR(counts(0, 0, 0, 31).mcnemar(), std::pow(2.0, -30), 1e-20);
  EXPECT_EQ(counts(5, 0, 5, 0).mcnemar(), 1) << "no disagreement says nothing";
  EXPECT_EQ(counts(5, 3, 5, 3).mcnemar(), 1);
}
TEST(Statistics, TheBootstrapOfTwoValuesHasTheThreeMeansThatThereAre) {
  // The mean is 0, 1/2 or 1 with probability 1/4, 1/2, 1/4.
  expect_interval(bootstrap_mean({0, 1}), 0, 1, 0);
  expect_interval(bootstrap_mean({0, 1}, {.level = 0.4}), 0.5, 0.5, 0);
  expect_interval(bootstrap_mean({3.25}), 3.25, 3.25, 0);
}
TEST(Statistics, TheBootstrapOfManyValuesIsTheNormalInterval) {
  std::vector<Real> values(400);
  for (std::size_t i = 0; i < 200; ++i) values[i] = 1;
  const Real half = 1.959964 * 0.5 / 20;  // standard error of the mean
  expect_interval(bootstrap_mean(values), 0.5 - half, 0.5 + half, 0.003);
}
TEST(Statistics, TheBootstrapIsThatOfAnIndependentProgramToTheLastDigits) {
  // mt19937_64 written anew in Python after its paper, and checked with the 10000th number that the C++ standard gives.
  expect_interval(bootstrap_mean(kErrors, {.resamples = 2000}), 15.12, 26.05, 1e-12);
  expect_interval(bootstrap_mean(kErrors, {.resamples = 2000, .level = 0.9, .seed = 7}), 16.2, 24.89, 1e-12);
}
TEST(Statistics, BadNumbersAreRefused) {
  EXPECT_THROW(wilson({1, 0}), InputError);
  EXPECT_THROW(wilson({-1, 3}), InputError);
  EXPECT_THROW(wilson({4, 3}), InputError);
  EXPECT_THROW(bootstrap_mean({}), InputError);
  EXPECT_THROW(bootstrap_mean({1}, {.level = 1}), SettingsError);
  EXPECT_THROW(mean({}), InputError);
}
