#include "robot/urdf/isolated.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>
#include <string>
using namespace robot;

TEST(Isolated, WhatTheWorkReturnsArrives) {
  EXPECT_EQ(run_isolated([] { return std::string(); }, 10, 100), "");
  std::string large(3'000'000, 'x');  // more than a pipe holds
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
                [] {
                  const volatile std::size_t many = 500'000'000;  // volatile: a compiler may see through an unused allocation
                  return std::string(many, 'x');
                },
                10, 100),
            std::nullopt);
}
