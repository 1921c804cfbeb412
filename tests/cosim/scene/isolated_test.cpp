#include "cosim/scene/isolated.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>
#include <vector>
using namespace cosim;

TEST(Isolated, WhatTheWorkReturnsArrives) {
  EXPECT_EQ(run_isolated([] { return std::string(); }, 10, 100), "");
  const std::string large(3'000'000, 'x');  // more than a pipe holds
  EXPECT_EQ(run_isolated([&] { return large; }, 10, 100), large);
}

TEST(Isolated, CrashesAndExceptionsAndEndlessWorkStayInside) {
  EXPECT_EQ(run_isolated(
                []() -> std::string {
                  std::raise(SIGSEGV);
                  return "alive";
                },
                10, 100),
            std::nullopt);
  EXPECT_EQ(run_isolated([]() -> std::string { throw std::runtime_error("no"); }, 10, 100), std::nullopt);
  EXPECT_EQ(run_isolated(
                []() -> std::string {
                  while (true) pause();
                },
                1, 100),
            std::nullopt);
  EXPECT_EQ(run_isolated(
                []() -> std::string {
                  std::vector<char> all(500'000'000);
                  return {all.data(), 1};
                },
                10, 100),
            std::nullopt);
}
