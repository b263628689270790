#include "tactus/bench/report_page.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tactus/bench/child_program.h"

namespace tactus {
namespace {

StudyResult onePlot() {
  Plot plot;
  plot.title = "A \"plot\"";
  plot.note = "note";
  plot.table = "measured";
  plot.x_column = "x";
  plot.y_column = "y";
  plot.x_label = "x in m";
  plot.y_label = "y in N";
  plot.x_scale = Scale::kLinear;
  plot.has_lines = false;
  plot.series = {{"all", {}}, {"some", {{"name", std::string("a")}, {"ratio", 0.1}}}};
  return {"One", "text", {}, {plot}, {{"measured", {"name", "ratio", "x", "y"}, {}}}};
}

TEST(ReportJson, SaysWhatToPlotOfWhichTable) {
  const nlohmann::json json = nlohmann::json::parse(reportJson({onePlot(), StudyResult()}));
  ASSERT_EQ(json["sections"].size(), 2u);
  const nlohmann::json& section = json["sections"][0];
  EXPECT_EQ(section["title"], "One");
  EXPECT_EQ(section["text"], "text");
  EXPECT_EQ(section["tables"], nlohmann::json({"measured"}));
  const nlohmann::json& plot = section["plots"][0];
  EXPECT_EQ(plot["title"], "A \"plot\"");
  EXPECT_EQ(plot["table"], "measured");
  EXPECT_EQ(plot["x"], "x");
  EXPECT_EQ(plot["y"], "y");
  EXPECT_EQ(plot["x_scale"], "linear");
  EXPECT_EQ(plot["y_scale"], "log");
  EXPECT_EQ(plot["has_lines"], false);
  EXPECT_EQ(plot["series"][0]["where"], nlohmann::json::object());
  EXPECT_EQ(plot["series"][1]["label"], "some");
  EXPECT_EQ(plot["series"][1]["where"], nlohmann::json({{"name", "a"}, {"ratio", 0.1}}));
  EXPECT_EQ(json["sections"][1]["plots"], nlohmann::json::array());
}

TEST(RunProgram, KeepsWhatWasWrittenToStandardErrorAlone) {
  const ChildResult result =
      runProgram({"sh", "-c", "echo out; head -c 100000 /dev/zero >&2; exit 7"});
  EXPECT_EQ(result.exit_code, 7);
  EXPECT_EQ(result.errors, std::string(100000, '\0'));
  EXPECT_EQ(runProgram({"sh", "-c", "kill -9 $$"}).exit_code, -1);
  EXPECT_EQ(runProgram({"/nowhere/program"}).exit_code, 127);
}

TEST(MakeReportPage, SaysInOneLineWhyThereIsNone) {
  const std::string missing = makeReportPage("/nowhere/tactus-report", ".");
  EXPECT_EQ(missing.find("/nowhere/tactus-report: cannot be run"), 0u) << missing;
  const std::string refused = makeReportPage("ls", "/nowhere");
  EXPECT_NE(refused.find("/nowhere"), std::string::npos);
  EXPECT_EQ(refused.find('\n'), std::string::npos);
  EXPECT_EQ(makeReportPage("true", "/nowhere"), "");
}

}  // namespace
}  // namespace tactus
