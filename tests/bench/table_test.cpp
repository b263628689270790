#include "tactus/bench/table.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tactus/bench/study.h"

namespace tactus {
namespace {

Table example() {
  return {"example",
          {"name", "x", "y"},
          {{std::string("a"), 1.0, 0.1},
           {std::string("b, \"c\""), 2.0, kNotMeasured},
           {std::string("a"), 10.0, 1e-17}}};
}

TEST(Table, IsCsvThatKeepsEveryBitAndQuotesWords) {
  EXPECT_EQ(csvText(example()), "name,x,y\na,1,0.1\n\"b, \"\"c\"\"\",2,\na,10,1e-17\n");
}

TEST(Table, FindsTheFirstRowThatMatchesAll) {
  EXPECT_EQ(findNumber(example(), "y", {{"name", std::string("a")}, {"x", 10.0}}), 1e-17);
  EXPECT_EQ(findNumber(example(), "x", {{"name", std::string("a")}}), 1.0);
  EXPECT_THROW(findNumber(example(), "y", {{"x", 3.0}}), std::out_of_range);
  EXPECT_THROW(findNumber(example(), "z", {}), std::out_of_range);
}

TEST(Table, FindsThePointsOfRowsThatMatch) {
  const auto points = findPoints(example(), "x", "y", {{"name", std::string("a")}});
  EXPECT_EQ(points, (std::vector<std::array<double, 2>>{{1.0, 0.1}, {10.0, 1e-17}}));
}

TEST(Goals, AreMetUpToTheirLimit) {
  StudyResult result;
  result.goals = {{"at", 2.0, 2.0}, {"above", 2.0, 2.001}, {"unknown", 2.0}};
  const Table table = goalTable({result});
  EXPECT_EQ(table.word(0, "met"), "yes");
  EXPECT_EQ(table.word(1, "met"), "no");
  EXPECT_EQ(table.word(2, "met"), "not measured");
}

}  // namespace
}  // namespace tactus
