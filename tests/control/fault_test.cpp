#include "tactus/control/fault.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

namespace tactus {
namespace {

TEST(Fault, HasItsRowAndName) {
  std::set<std::string> names;
  for (const FaultRow& row : faultTable()) {
    EXPECT_EQ(&faultRow(row.fault), &row);
    EXPECT_EQ(faultName(row.fault), row.name);
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
  }
  EXPECT_STREQ(faultName(Fault::kNone), "none");
}

/// A phrase of plain text that each page puts into a line of its own; marks come in pairs.
TEST(Fault, HasARemedy) {
  for (const FaultRow& row : faultTable()) {
    const std::string remedy = row.remedy;
    EXPECT_EQ(remedy.empty(), row.fault == Fault::kNone) << row.name;
    EXPECT_EQ(std::count(remedy.begin(), remedy.end(), '`') % 2, 0) << row.name;
    EXPECT_EQ(remedy.find_first_of("|\\\n"), std::string::npos) << row.name;
    EXPECT_FALSE(remedy.ends_with('.')) << row.name;
  }
}

/// As of a log that a newer version has written.
TEST(Fault, OfANumberThatIsNoneIsUnknown) {
  const auto beyond = static_cast<Fault>(faultTable().size());
  for (const Fault fault : {beyond, static_cast<Fault>(255)}) {
    EXPECT_EQ(&faultRow(fault), &faultRow(Fault::kNone));
    EXPECT_STREQ(faultName(fault), "unknown");
  }
}

TEST(Fault, ReactionsHaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (int i = 0; i <= static_cast<int>(Reaction::kBrake); ++i)
    EXPECT_TRUE(names.insert(reactionName(static_cast<Reaction>(i))).second) << i;
  EXPECT_STREQ(reactionName(Reaction::kNone), "none");
  EXPECT_STREQ(reactionName(Reaction::kRamp), "ramp");
}

}  // namespace
}  // namespace tactus
