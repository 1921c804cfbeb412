#include "apps/report/table.hpp"

#include <gtest/gtest.h>

using namespace tape::report;

TEST(Table, NumbersStandRightAndTextLeft) {
  EXPECT_EQ(to_text({{"name", "ms"}, {{"a", "10.5"}, {"long name", "2"}}}),
            "name         ms\n"
            "a          10.5\n"
            "long name     2\n");
}
TEST(Table, ACsvCellIsQuotedOnlyWhereItMustBe) {
  EXPECT_EQ(to_csv({{"a", "b"}, {{"plain", "1,5"}, {"say \"no\"", ""}}}), "a,b\nplain,\"1,5\"\n\"say \"\"no\"\"\",\n");
}
TEST(Table, ANumberForPeopleHasFourDigits) {
  EXPECT_EQ(rounded(0.123456), "0.1235");
  EXPECT_EQ(rounded(1234567), "1.235e+06");
}
