#include "tactus/record/ulog_reader.h"

#include <gtest/gtest.h>

#include <functional>

#include "support/telemetry.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

using namespace std::string_literals;

std::string message(char type, const std::string& payload) {
  return std::string{static_cast<char>(payload.size() & 0xff),
                     static_cast<char>(payload.size() >> 8), type} +
         payload;
}

template <typename Number>
std::string raw(Number number) {
  return {reinterpret_cast<const char*>(&number), sizeof(number)};
}

/// A log by hand, one part after the other, so that each can be spoilt.
struct HandMadeLog {
  std::string header = "ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0"s;
  std::string flags = message('B', std::string(40, '\0'));
  std::string format;
  std::string definitions;
  std::string subscription = message('A', "\0\0\0cycle"s);
  std::string data;

  HandMadeLog() {
    std::string text = "cycle:uint64_t timestamp;";
    for (const RecordField& field : recordFields()) text += declaration(field);
    format = message('F', text);
  }

  static std::string declaration(const RecordField& field) {
    const std::string array = field.shape == FieldShape::kPerJoint ? "[2]" : "";
    return typeName(field.type) + array + " " + field.name + ";";
  }

  void replaceInFormat(const std::string& from, const std::string& to) {
    std::string text = format.substr(3);
    text.replace(text.find(from), from.size(), to);
    format = message('F', text);
  }

  std::string bytes() const { return header + flags + format + definitions + subscription + data; }
};

std::string complaintOf(const HandMadeLog& log) {
  try {
    test::readLog(log.bytes());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(UlogReader, FindsFieldsByNameWhateverTheirOrderAndNeighbours) {
  HandMadeLog log;
  std::string text = "cycle:uint8_t unknown;uint64_t timestamp;float[3] others;";
  std::string data = "\0\0"s + "u" + raw(std::uint64_t{5}) + std::string(12, 'x');
  std::vector<std::uint64_t> expected;
  const auto fields = recordFields();
  double number = 0.0;
  for (auto field = fields.rbegin(); field != fields.rend(); ++field) {
    text += HandMadeLog::declaration(*field);
    for (std::size_t i = 0; i < RecordShape{2, 1, true, 1, true, true}.entries(*field); ++i)
      data += raw(number += 1.0);
  }
  log.format = message('F', text);
  log.data = message('D', data);
  const auto read = test::readLog(log.bytes());
  ASSERT_EQ(read.records.size(), 1u);
  EXPECT_EQ(read.records[0].speed_share, 1.0);
  EXPECT_EQ(read.records[0].tool_rotation_error_rad, 4.0);
  EXPECT_EQ(read.records[0].tactile_moment_x_Nm[0], 3.0);
  EXPECT_EQ(read.records[0].tool_error_m[2], 11.0);
  EXPECT_EQ(read.records[0].tool_error_m[0], 13.0);
  EXPECT_EQ(read.records[0].q_measured[0], 19.0);
  EXPECT_EQ(read.records[0].q_measured[1], 20.0);
  EXPECT_EQ(read.records[0].t_s, number);
}

TEST(UlogReader, PassesOverOtherTopicsAndHarmlessMessages) {
  HandMadeLog log;
  log.definitions = message('F', "other:uint64_t timestamp;nested[9999999] x;") +
                    message('I', "\x0b"s + "float[2] xy" + std::string(8, '\0')) +
                    message('M', "\0\x08"s + "int8_t m" + "m") + message('A', "\0\1\0other"s) +
                    message('Q', "whatever");
  const std::size_t size = 2 + 8 + 8 * (17 + 4 + 3 + 3 + 2 + 5 + 3 + 5 + 5);
  log.data = message('D', "\1\0"s + "other topic") + message('L', "6text") + message('S', "sync") +
             message('O', "\5\0"s) + message('D', std::string(size, '\0')) + message('R', "\1\0"s);
  EXPECT_EQ(test::readLog(log.bytes()).records.size(), 1u);
}

TEST(UlogReader, ReadsALogOfBeforeThereWereMissedCycles) {
  HandMadeLog log;
  log.replaceInFormat("uint64_t missed_cycles;", "");
  log.replaceInFormat("double path_time_s;", "");
  log.replaceInFormat("double tactile_moment_x_Nm;", "");
  log.replaceInFormat("uint64_t modules_lost;double speed_share;", "");
  log.data = message('D', "\0\0"s + std::string(8 + 8 * (17 + 4 + 3 + 3 + 2 + 5 + 3 + 5), '\0'));
  EXPECT_EQ(test::readLog(log.bytes()).records.size(), 1u);
  for (const HandMadeLog& candidate : {log, HandMadeLog()}) {
    std::istringstream in(candidate.bytes());
    const UlogReader reader(in, "run.ulg");
    EXPECT_EQ(reader.has("missed_cycles"), candidate.format != log.format);
    EXPECT_TRUE(reader.has("mode"));
  }
}

TEST(UlogReader, RefusesEachWithItsPlace) {
  struct Case {
    std::function<void(HandMadeLog&)> spoil;
    std::string complaint;
  };
  const auto define = [](std::string text) {
    return [text](HandMadeLog& log) { log.definitions = text; };
  };
  const auto swap = [](std::string from, std::string to) {
    return [from, to](HandMadeLog& log) { log.replaceInFormat(from, to); };
  };
  const std::string big(60000, 'x');
  const std::vector<Case> cases = {
      {[](HandMadeLog& log) { log.header = log.flags = log.format = log.subscription = ""; },
       "run.ulg:1:1: header: is empty"},
      {[](HandMadeLog& log) { log.header[1] = 'l'; }, "run.ulg:1:1: header: not a ULog"},
      {[](HandMadeLog& log) { log.header[7] = 2; }, "run.ulg:1:1: header: not a ULog"},
      {[](HandMadeLog& log) { log.flags.clear(); }, "run.ulg:1:17: flag bits: missing"},
      {[](HandMadeLog& log) { log.flags = message('B', "short"); }, "run.ulg:1:17: flag bits"},
      {[](HandMadeLog& log) { log.flags[3 + 8] = 1; }, "message B: incompatible flags"},
      {[](HandMadeLog& log) { log.format.clear(); }, "no format of the cycles"},
      {[](HandMadeLog& log) { log.definitions = log.format; }, "a second format"},
      {[](HandMadeLog& log) { log.subscription.clear(); }, "definitions: the log ends here"},
      {[](HandMadeLog& log) { log.subscription = message('A', "\0"s); }, "message A: too short"},
      {swap("double[2] q;", "double[1] q;"), "2 to 16 are expected"},
      {swap("double[2] q;", "double[17] q;"), "2 to 16 are expected"},
      {swap("double[2] q;", "double[2] p;"), "2 to 16 are expected"},
      {swap("double w;", "double[7] w;"), "1 to 6 are expected"},
      {swap("double w;", "double[0] w;"), "\"double[0] w\" is no field"},
      {swap("double[2] dq;", "double[3] dq;"), "no field dq of type double[2]"},
      {swap("double gamma;", "float gamma;"), "no field gamma of type double[1]"},
      {swap("uint64_t fault;", ""), "no field fault of type uint64_t[1]"},
      {swap("uint64_t missed_cycles;", "double missed_cycles;"), "no field missed_cycles of type"},
      {swap("double gamma;", "double[99999999999999999999] gamma;"), "is no field"},
      {swap("double gamma;", "double[-1] gamma;"), "is no field"},
      {swap("double gamma;", "double[1 gamma;"), "is no field"},
      {swap("double gamma;", "double[ gamma;"), "\"double[ gamma\" is no field"},
      {swap("double gamma;", "double gamma;double[65535] more;"), "larger than a message"},
      {swap("double gamma;", "double;"), "\"double\" is no field"},
      {swap("double gamma;", "double ;"), "is no field"},
      {swap("double gamma;", "cycle gamma;"), "\"cycle gamma\" is no field"},
      {swap("double gamma;", "dou\nble gamma;"), "dou\\x0able"},
      {define(message('I', "")), "message I: no key"},
      {define(message('I', "\x0fshort")), "message I: no key"},
      {define(message('I', "\x04name")), "message I: no key"},
      {define(message('P', "\x07"s + "float x" + "abc")), "message P: no number"},
      {define(message('P', "\x08"s + "double x" + std::string(8, '\0'))), "message P: no number"},
      {define(message('M', "")), "message M: no content"},
      {define(message('M', "\0\x13"s + "char[2] source_textx")), "message M: no text"},
      {define(message('M', "\1\x13"s + "char[1] source_textx")), "message M: continues nothing"},
      {define(message('M', "\0\x13"s + "char[1] source_textx")), "incomplete"},
      {define(message('M', "\0\x14"s + "char[1] override_keyx")), "incomplete"},
      {define(message('X', "")), "message: unknown type 0x58"},
      {define(message('B', std::string(40, '\0'))), "message: unknown type 0x42"},
      {[](HandMadeLog& log) { log.data = message('D', "\0"s); }, "message D: too short"},
      {[](HandMadeLog& log) { log.data = message('D', "\0\0abc"s); },
       "message D: a cycle in 5 bytes"},
      {[](HandMadeLog& log) { log.data = message('\xee', ""); }, "message: unknown type 0xee"},
  };
  EXPECT_EQ(complaintOf(HandMadeLog()), "");
  for (const Case& c : cases) {
    HandMadeLog log;
    c.spoil(log);
    EXPECT_NE(complaintOf(log).find(c.complaint), std::string::npos)
        << "expected: " << c.complaint << "\ngot: " << complaintOf(log);
  }
}

TEST(UlogReader, RefusesEndlessText) {
  HandMadeLog log;
  const std::string chunk =
      message('M', "\1\x17"s + "char[60000] source_text" + std::string(60000, 'x'));
  log.definitions = message('M', "\0\x13"s + "char[0] source_text");
  for (int i = 0; i < 1200; ++i) log.definitions += chunk;
  EXPECT_NE(complaintOf(log).find("at most 64 MiB"), std::string::npos) << complaintOf(log);
}

TEST(UlogReader, RefusesEndlessInfosAndParameters) {
  const std::string info = message('I', "\x0e"s + "char[60000] xx" + std::string(60000, 'x'));
  const std::string parameter = message('P', "\x07"s + "float x" + raw(1.0f));
  const std::pair<std::string, int> endless[] = {{info, 1200}, {parameter, 1'000'000}};
  for (const auto& [text, count] : endless) {
    HandMadeLog log;
    for (int i = 0; i < count; ++i) log.definitions += text;
    EXPECT_NE(complaintOf(log).find("at most 64 MiB"), std::string::npos) << complaintOf(log);
  }
}

}  // namespace
}  // namespace tactus
