#include "tape/core/hash.hpp"

#include <gtest/gtest.h>
using namespace tape;

TEST(Hash, IsFnv1a) {  // published test vectors of the 64-bit variant
  const auto of = [](const std::string& text) {
    Hash hash;
    hash.add(text.data(), text.size());
    return hash.text();
  };
  EXPECT_EQ(of(""), "cbf29ce484222325");
  EXPECT_EQ(of("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(of("foobar"), "85944171f73967e8");
}
