#include "tactus/bench/table.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tactus/bench/plot.h"
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

TEST(Plot, LeavesOutWhatHasNoPlaceOnItsAxes) {
  Plot plot;
  plot.title = "<T & \"T\">";
  plot.series = {select(example(), "all", "x", "y", {})};
  const std::string svg = svgText(plot);
  int circles = 0;
  for (std::size_t at = 0; (at = svg.find("<circle", at)) != std::string::npos; ++at) ++circles;
  EXPECT_EQ(circles, 2 + 1) << "two points and the legend";
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_NE(svg.find("&lt;T &amp; &quot;T&quot;&gt;"), std::string::npos);
}

TEST(Plot, CanBeEmpty) {
  const std::string svg = svgText(Plot{});
  EXPECT_EQ(svg.find("nan"), std::string::npos) << svg;
  EXPECT_EQ(svg.find("inf"), std::string::npos) << svg;
}

TEST(Goals, AreMetUpToTheirLimit) {
  StudyResult result;
  result.goals = {{"at", 2.0, 2.0}, {"above", 2.0, 2.001}, {"unknown", 2.0}};
  const Table table = goalTable({result});
  EXPECT_EQ(table.word(0, "met"), "yes");
  EXPECT_EQ(table.word(1, "met"), "no");
  EXPECT_EQ(table.word(2, "met"), "not measured");
}

TEST(Report, HoldsEveryTableAndPlot) {
  StudyResult result;
  result.title = "One";
  result.plots = {Plot{}, Plot{}};
  result.tables = {example()};
  const std::string page = reportPage({result, result});
  int drawings = 0;
  for (std::size_t at = 0; (at = page.find("<svg", at)) != std::string::npos; ++at) ++drawings;
  EXPECT_EQ(drawings, 4);
  EXPECT_NE(page.find("example.csv"), std::string::npos);
  EXPECT_NE(page.find("b, &quot;c&quot;"), std::string::npos);
}

}  // namespace
}  // namespace tactus
