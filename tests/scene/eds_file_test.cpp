#include "tactus/scene/eds_file.h"

#include <gtest/gtest.h>

#include <random>
#include <regex>

#include "support/eds_text.h"
#include "tactus/scene/eds_object.h"
#include "tactus/scene/source_reader.h"

namespace tactus {
namespace {

std::string parseError(const std::string& text) {
  try {
    parseEds({"drive.eds", text});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expectParseError(const std::string& text, const std::string& place,
                      const std::string& problem) {
  const std::string error = parseError(text);
  EXPECT_EQ(error.substr(0, place.size()), place) << error;
  EXPECT_NE(error.find(problem), std::string::npos) << error;
  EXPECT_NE(error.find(", expected "), std::string::npos) << error;
}

const std::string kList = "[MandatoryObjects]\nSupportedObjects=1\n1=0x1000\n";

TEST(EdsNumber, IsReadInEverySpelling) {
  const auto plain = [](std::int64_t value) { return EdsNumber{value, false}; };
  EXPECT_EQ(parseEdsNumber("42"), plain(42));
  EXPECT_EQ(parseEdsNumber("-3"), plain(-3));
  EXPECT_EQ(parseEdsNumber("0"), plain(0));
  EXPECT_EQ(parseEdsNumber("0x1aF"), plain(0x1AF));
  EXPECT_EQ(parseEdsNumber("0XFFFFFFFF"), plain(0xFFFFFFFF));
  EXPECT_EQ(parseEdsNumber("017"), plain(15)) << "octal";
  EXPECT_EQ(parseEdsNumber(" 5\t"), plain(5));
  for (const char* const text :
       {"$NODEID+0x180", "$NodeID + 0x180", "0x180+$nodeid", " 384 + $NODEID "})
    EXPECT_EQ(parseEdsNumber(text), (EdsNumber{0x180, true})) << text;
  EXPECT_EQ(parseEdsNumber("$NODEID"), (EdsNumber{0, true}));
}

TEST(EdsNumber, IsNothingElse) {
  for (const char* const text : {"",
                                 " ",
                                 "-",
                                 "0x",
                                 "08",
                                 "1.5",
                                 "1e3",
                                 "12 3",
                                 "0x1G",
                                 "--1",
                                 "+1",
                                 "$NODEID+",
                                 "+$NODEID",
                                 "$NODE+1",
                                 "$NODEID+$NODEID",
                                 "1+2",
                                 "$NODEID-1",
                                 "0x10000000000000000",
                                 "99999999999999999999",
                                 "9223372036854775808",
                                 "\"5\""})
    EXPECT_EQ(parseEdsNumber(text), std::nullopt) << text;
}

TEST(EdsFile, FindsSectionsAndKeysInAnyCase) {
  const EdsFile eds = parseEds({"drive.eds", kList + "[1018SUB01]\nDataType = 0x7 \n"});
  const EdsSection* const section = eds.find("1018sub1");
  ASSERT_NE(section, nullptr);
  EXPECT_EQ(section->name, "1018SUB01");
  EXPECT_EQ(section->at.line, 4);
  ASSERT_NE(section->find("DATATYPE"), nullptr);
  EXPECT_EQ(section->find("datatype")->text, "0x7");
  EXPECT_EQ(section->find("datatype")->at.line, 5);
  EXPECT_EQ(section->find("ObjectType"), nullptr);
  EXPECT_EQ(eds.find("1018"), nullptr);
}

TEST(EdsFile, LeavesOutWhatIsNoSection) {
  const EdsFile eds =
      parseEds({"drive.eds",
                "\xEF\xBB\xBF; made by\r\n# hand\r\n\r\n[MandatoryObjects]\r\n"
                "SupportedObjects=0x1\r\n1=0x1000\r\n  [Comments]  \r\n Line1=a;b=c\r\n"});
  ASSERT_EQ(eds.objects.size(), 1u);
  EXPECT_EQ(eds.objects.at(0x1000).line, 6);
  ASSERT_NE(eds.find("comments"), nullptr);
  EXPECT_EQ(eds.find("comments")->find("line1")->text, "a;b=c");
  EXPECT_EQ(eds.find("comments")->at.line, 7);
  EXPECT_EQ(eds.find("comments")->at.column, 3);
  EXPECT_EQ(eds.find("comments")->find("line1")->at.column, 2);
}

TEST(EdsFile, SaysWhereItIsNoEds) {
  expectParseError("", "drive.eds:1:1: MandatoryObjects: ", "no list of objects");
  expectParseError(kList + "[1000\n", "drive.eds:4:1: -: ", "'[1000' is no name");
  expectParseError(kList + "[ ]\n", "drive.eds:4:1: -: ", "is no name");
  expectParseError(kList + "[1000]\n  nonsense\n", "drive.eds:5:3: 1000: ", "is no value");
  expectParseError(kList + "=5\n", "drive.eds:4:1: MandatoryObjects: ", "is no value");
  expectParseError("A=1\n" + kList, "drive.eds:1:1: -: ", "is in no section");
  expectParseError(kList + "[1000]\n[1000]\n", "drive.eds:5:1: 1000: ", "already, in line 4");
  expectParseError(kList + "[1018sub1]\n[1018SUB01]\n",
                   "drive.eds:5:1: 1018SUB01: ", "already, in line 4");
  expectParseError(kList + "[1000]\nA=1\na=2\n", "drive.eds:6:1: 1000.a: ", "already, in line 5");
}

TEST(EdsFile, ListsAsManyObjectsAsItSays) {
  const char* const place = "drive.eds:2:1: MandatoryObjects.SupportedObjects: ";
  const auto list = [](const std::string& lines) { return "[MandatoryObjects]\n" + lines; };
  expectParseError(list("SupportedObjects=2\n1=0x1000\n"), place, "expected 1,");
  expectParseError(list("SupportedObjects=1\n1=0x1000\n2=0x1001\n"), place, "expected 2,");
  expectParseError(list("SupportedObjects=many\n1=0x1000\n"), place, "'many' is not");
  expectParseError(list("1=0x1000\n"),
                   "drive.eds:1:1: MandatoryObjects.SupportedObjects: ", "is missing");
  expectParseError(list("SupportedObjects=1\n1=0x10000\n"),
                   "drive.eds:3:1: MandatoryObjects.1: ", "is no object");
  expectParseError(list("SupportedObjects=1\n1=$NODEID\n"),
                   "drive.eds:3:1: MandatoryObjects.1: ", "is no object");
  expectParseError(list("SupportedObjects=2\n1=0x1000\n2=4096\n"),
                   "drive.eds:4:1: MandatoryObjects.2: ", "1000 is listed twice");
  expectParseError(kList + "[OptionalObjects]\nSupportedObjects=1\n1=0x1000\n",
                   "drive.eds:6:1: OptionalObjects.1: ", "1000 is listed twice");
}

std::string objectError(const std::string& text, std::uint16_t index, std::uint8_t subindex) {
  try {
    findEdsObject(parseEds({"drive.eds", text}), index, subindex);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(EdsObject, IsAVariableARecordOrCompact) {
  const EdsFile eds = parseEds({"drive.eds", test::edsText()});
  const auto position = findEdsObject(eds, 0x6064, 0);
  ASSERT_TRUE(position);
  EXPECT_EQ(position->type, (EdsType{4, true}));
  EXPECT_TRUE(position->is_mappable && position->isReadable() && !position->isWritable());
  EXPECT_FALSE(position->initial) << "said to be empty";
  const auto cob_id = findEdsObject(eds, 0x1800, 1);
  ASSERT_TRUE(cob_id);
  EXPECT_EQ(cob_id->initial, (EdsNumber{0x40000180, true}));
  EXPECT_FALSE(findEdsObject(eds, 0x1800, 5));
  EXPECT_FALSE(findEdsObject(eds, 0x6064, 1));
  EXPECT_FALSE(findEdsObject(eds, 0x2000, 0));
  const auto exponent = findEdsObject(eds, 0x60C2, 2);
  ASSERT_TRUE(exponent);
  EXPECT_EQ(exponent->inType(exponent->lowest->value), -6);

  const EdsFile compact = parseEds(
      {"drive.eds", kList + "[1000]\nObjectType=8\nDataType=7\nAccessType=RW\nCompactSubObj=2\n"
                            "DefaultValue=9\nPDOMapping=1\n"});
  EXPECT_EQ(findEdsObject(compact, 0x1000, 0)->initial, (EdsNumber{2, false}));
  EXPECT_EQ(findEdsObject(compact, 0x1000, 0)->type, (EdsType{1, false}));
  EXPECT_FALSE(findEdsObject(compact, 0x1000, 0)->isWritable());
  EXPECT_EQ(findEdsObject(compact, 0x1000, 2)->initial, (EdsNumber{9, false}));
  EXPECT_TRUE(findEdsObject(compact, 0x1000, 2)->isWritable());
  EXPECT_FALSE(findEdsObject(compact, 0x1000, 3));
}

TEST(EdsObject, IsRefusedWhereTheSheetContradictsItself) {
  const std::string eds = test::edsText();
  const auto expectProblem = [](const std::string& text, std::uint16_t index, std::uint8_t subindex,
                                const std::string& key, const std::string& problem) {
    const std::string error = objectError(text, index, subindex);
    EXPECT_NE(error.find(": " + key + ": "), std::string::npos) << error;
    EXPECT_NE(error.find(problem), std::string::npos) << error;
  };
  expectProblem(eds + "[6100]\nObjectType=7\n", 0x6100, 0, "6100", "in no list");
  expectProblem(test::withEdsLine(eds, "1018", "SubNumber", "SubNumber=4"), 0x1018, 1,
                "1018.SubNumber", "4 is not the number of its sections, expected 5");
  expectProblem(test::withEdsLine(eds, "60FF", "DataType", "DataType=0x0009"), 0x60FF, 0,
                "60FF.DataType", "0x0009 is no whole number");
  expectProblem(test::withEdsLine(eds, "60FF", "DataType", "DataType=INTEGER32"), 0x60FF, 0,
                "60FF.DataType", "'INTEGER32' is no number");
  expectProblem(test::withEdsLine(eds, "60FF", "DataType", ";"), 0x60FF, 0, "60FF.DataType",
                "is missing");
  expectProblem(test::withEdsLine(eds, "60FF", "AccessType", "AccessType=all"), 0x60FF, 0,
                "60FF.AccessType", "'all' is none");
  expectProblem(test::withEdsLine(eds, "60FF", "ObjectType", "ObjectType=0x2"), 0x60FF, 0,
                "60FF.ObjectType", "0x2 has no number");
  expectProblem(test::withEdsLine(eds, "60FF", "PDOMapping", "PDOMapping=yes"), 0x60FF, 0,
                "60FF.PDOMapping", "'yes' is no number");
}

/// Whatever bytes change: read, or refused in one line that says where.
TEST(EdsFile, SurvivesAnyChange) {
  const std::string eds = test::edsText();
  const std::regex form("^drive\\.eds:[1-9][0-9]*:[1-9][0-9]*: [^:]+: .*, expected .");
  std::mt19937 random(7);
  int refused = 0;
  for (int run = 0; run < 400; ++run) {
    std::string text = eds;
    for (int change = 0; change < 1 + run % 4; ++change) {
      const std::size_t at = random() % text.size();
      if (random() % 3 == 0)
        text.erase(at, 1 + random() % 40);
      else if (random() % 2 == 0)
        text.insert(at, text.substr(random() % text.size(), random() % 60));
      else
        text[at] = static_cast<char>(1 + random() % 255);
    }
    for (const auto& [index, subindex] : {std::pair{0x60FF, 0}, {0x1018, 1}, {0x1400, 1}}) {
      const std::string error =
          objectError(text, static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(subindex));
      if (error.empty()) continue;
      ++refused;
      EXPECT_TRUE(std::regex_search(error, form)) << error;
      EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    }
  }
  EXPECT_GT(refused, 50);
  EXPECT_LT(refused, 1150);
}

TEST(EdsFile, IsNotSlowedByMany) {
  std::string text = kList + "[A]\n";
  for (int i = 0; text.size() < kMaxFileBytes; ++i) text += std::to_string(i) + "=\n";
  EXPECT_EQ(parseEds({"drive.eds", text}).sections.size(), 2u);
}

}  // namespace
}  // namespace tactus
