#include "tactus/cli/calibrate_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>
#include <vector>

#include "tactus/cli/commission_text.h"
#include "tactus/cli/push_file.h"
#include "tactus/cli/wrench_rows.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/number_text.h"
#include "tactus/scene/source_reader.h"

namespace tactus {
namespace {

constexpr int kLeastHeldSamples = 20;
constexpr double kFeltSigmas = 10.0;
constexpr double kLeastSigma = 0.5;  ///< steps: of a channel that is quieter, its rounding
constexpr double kMaxChange = 0.2;   ///< of a push while it is held
constexpr double kLargestSaid_N = 1e4;

/// A comma ends a word, but within one it may be meant as a decimal point.
std::vector<std::string> wordsOf(const std::string& line) {
  constexpr std::string_view kSpaces = " \t\r";
  std::vector<std::string> words(1);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    const bool ends = i + 1 == line.size() || kSpaces.find(line[i + 1]) != std::string_view::npos;
    const bool is_space = kSpaces.find(c) != std::string_view::npos || (c == ',' && ends);
    if (is_space && !words.back().empty()) words.emplace_back();
    if (!is_space) words.back() += c;
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

std::optional<double> numberOf(const std::string& word) {
  const std::optional<double> value = finiteNumber(word);
  return value && std::abs(*value) <= kLargestSaid_N ? value : std::nullopt;
}

/// "5 +y" as (0, 5, 0); empty: the words begin otherwise.
std::optional<Vector3> alongAnAxis(const std::vector<std::string>& words) {
  if (words.size() < 2 || words[1].size() != 2) return std::nullopt;
  const char sign = words[1][0], axis = words[1][1];
  const std::optional<double> size = numberOf(words[0]);
  if (!size || !(*size > 0.0) || (sign != '+' && sign != '-') || axis < 'x' || axis > 'z')
    return std::nullopt;
  return (sign == '+' ? *size : -*size) * Vector3::Unit(axis - 'x');
}

/// The file that is begun, or gone on with.
class Recording {
 public:
  explicit Recording(const RecordSession& session) : session_(session) {
    if (!std::filesystem::exists(session.path)) {
      checkFolder(session.path);
      file_.link = session.link;
      return;
    }
    SourceReader reader(readFromDisk);
    const SourceFile source = reader.readFirst(session.path);
    file_ = readPushFile(source);
    const SourcePosition begin = beginOf(session.path);
    if (file_.link != session.link)
      failAt(begin, "module", "the pushes are of " + inQuotes(file_.link),
             "expected those of " + inQuotes(session.link) + ", or another file");
    pushes_ = pushesOf(file_);
    needs_line_break_ = !source.text.empty() && source.text.back() != '\n';
    checkContinuation(source, begin);
  }

  void addZero(const ChannelFigures& figures) {
    append(zeroRecord(figures));
    zero_ = figures;
  }

  void addPush(const KnownPush& push, const ChannelFigures& figures) {
    append(pushRecord(push, figures));
    pushes_.push_back(push);
  }

  const ChannelFigures& zero() const { return zero_; }
  const std::vector<KnownPush>& pushes() const { return pushes_; }

 private:
  static void checkFolder(const std::string& path) {
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    if (!folder.empty() && !std::filesystem::is_directory(folder))
      failAt(beginOf(path), "-", "its folder is not there", "expected a file in a folder that is");
  }

  void checkContinuation(const SourceFile& source, const SourcePosition& begin) const {
    const std::string joint = needs_line_break_ ? "\n" : "";
    try {
      readPushFile(SourceFile{source.path, source.text + joint + zeroRecord({})});
    } catch (const InputError&) {
      failAt(begin, "records", "nothing can be appended to the file",
             "expected records last, in lines that begin with two spaces and -");
    }
  }

  /// As a whole or not at all: half of a record would make the file useless.
  void append(const std::string& record) {
    const bool is_new = !std::filesystem::exists(session_.path);
    const auto size = is_new ? 0 : std::filesystem::file_size(session_.path);
    std::ofstream out(session_.path, std::ios::binary | std::ios::app);
    out << (is_new ? pushFileBeginning(session_.link) : needs_line_break_ ? "\n" : "") << record;
    out.close();
    const std::string problem = out ? "" : std::strerror(errno);
    if (!problem.empty()) {
      std::error_code ignored;  // the first one is told
      if (is_new)
        std::filesystem::remove(session_.path, ignored);
      else
        std::filesystem::resize_file(session_.path, size, ignored);
      throw RunError(escaped(session_.path) + ": cannot be written: " + problem);
    }
    needs_line_break_ = false;
  }

  const RecordSession& session_;
  PushFile file_;
  std::vector<KnownPush> pushes_;
  ChannelFigures zero_;
  bool needs_line_break_ = false;
};

/// A second enter while a push is measured, say, would be the next answer, and an empty one ends.
/// What is answered has no blanks about it.
bool ask(const RecordSession& session, const std::string& question, std::string& answer) {
  if (session.forget_typed) session.forget_typed();
  fmt::print(session.out, "{}", question);
  std::fflush(session.out);
  const bool is_answered = session.answer(answer);
  if (is_answered) answer = trimmedLine(answer);
  return is_answered;
}

/// Waits for enter alone, or for `other` where there is such an answer: what was typed for the next
/// question, say, shall not begin to measure. False: there are no more answers.
bool askForEnter(const RecordSession& session, const std::string& question,
                 const std::string& other, std::string& answer) {
  while (ask(session, question, answer)) {
    if (answer.empty() || answer == other) return true;
    fmt::print(session.out, "{} is no answer, expected enter{}\n", inQuotes(answer),
               other.empty() ? "" : " or " + other);
  }
  return false;
}

/// False: there are no more answers.
bool takeZero(const RecordSession& session, Recording& recording) {
  std::string answer;
  const std::string question = fmt::format(
      "zero of {}: hands off, then enter, and keep off for {:g} s: ", escaped(session.link),
      kZero_s);
  while (askForEnter(session, question, "", answer)) {
    const ChannelWindow window = listen(session.frames, session.module, kZero_s);
    if (const auto defect = window.defect()) {
      fmt::print(session.out, "refused: {}\n", defectText(*defect));
      continue;
    }
    recording.addZero(window.figures());
    fmt::print(session.out, "{}", channelTable(recording.zero()));
    return true;
  }
  return false;
}

std::string toldSoFar(const RecordSession& session, const std::vector<KnownPush>& pushes) {
  int row = 0;
  const double condition = pushesCondition(pushes, session.shape, &row);
  if (condition <= kMaxPushesCondition) {
    const int unchecked = uncheckedPushes(pushes, session.shape);
    return fmt::format("{} pushes, condition {:.2g}: {}\n", pushes.size(), condition,
                       unchecked == 0 ? "enough, more make it better"
                                      : fmt::format("{} of them nothing checks yet", unchecked));
  }
  return fmt::format("{} pushes, which do not tell {} yet\n", pushes.size(), kWrenchRows[row].name);
}

/// False: there are no more answers.
bool takePush(const RecordSession& session, const KnownPush& push, Recording& recording) {
  std::string answer;
  const std::string question =
      fmt::format("hold it, then enter, and hold it for {:g} s (s: skip it): ", kHeld_s);
  if (!askForEnter(session, question, "s", answer)) return false;
  if (!answer.empty()) return true;
  const ChannelWindow window = listen(session.frames, session.module, kHeld_s);
  const std::string problem = pushProblem(window, recording.zero());
  if (!problem.empty()) {
    fmt::print(session.out, "refused: {}\n", problem);
    return true;
  }
  recording.addPush(push, window.figures());
  fmt::print(session.out, "{}", toldSoFar(session, recording.pushes()));
  return true;
}

}  // namespace

bool parsePush(const std::string& line, double length_m, KnownPush& push, std::string& problem) {
  const std::vector<std::string> words = wordsOf(line);
  const std::optional<Vector3> along = alongAnAxis(words);
  std::vector<double> numbers;
  for (std::size_t i = along ? 2 : 0; i < words.size(); ++i) {
    const std::optional<double> number = numberOf(words[i]);
    problem = inQuotes(words[i]) + " is no number";
    if (!number) return false;
    numbers.push_back(*number);
  }
  const Vector3 force = along                ? *along
                        : numbers.size() < 3 ? Vector3::Zero()
                                             : Vector3(numbers.data());
  if (!along)
    numbers.erase(numbers.begin(), numbers.begin() + std::min<long>(3, std::ssize(numbers)));
  problem = "expected force and place, as 5 +y 0.1 or 0 5 0 0.1, and a moment about x, or none";
  if (numbers.empty() || numbers.size() > 2) return false;
  push = {force.y(), force.z(), numbers[0], numbers.size() > 1 ? numbers[1] : 0.0};
  problem = "a force along x, which no module tells";
  if (force.x() != 0.0) return false;
  problem = fmt::format("{:g} m is not on the cover, expected 0 to {:g} m", numbers[0], length_m);
  if (numbers[0] < 0.0 || numbers[0] > length_m) return false;
  problem = "there is no force";
  return force.norm() > 0.0 || push.moment_x_Nm != 0.0;
}

std::string pushProblem(const ChannelWindow& held, const ChannelFigures& zero) {
  const ChannelFigures now = held.figures();
  if (now.samples < kLeastHeldSamples) return fmt::format("{} samples are too few", now.samples);
  if (const auto defect = held.defect(&zero)) return defectText(*defect) + ": push less";
  const ChannelVector moved = now.mean - zero.mean;
  const double rounding = kLeastSigma * std::max(now.step, zero.step);
  const double sigmas = moved.cwiseAbs().cwiseQuotient(zero.sigma.cwiseMax(rounding)).maxCoeff();
  if (sigmas < kFeltSigmas)
    return fmt::format(
        "no channel moved by more than {:.1f} times its noise: push more, or is the module on?",
        sigmas);
  const double change = (now.drift_per_s * now.duration_s).norm() / moved.norm();
  if (change > kMaxChange)
    return fmt::format("the push changed by {:.0f} % while it was measured: hold it still",
                       100.0 * change);
  return "";
}

void recordPushes(const RecordSession& session) {
  Recording recording(session);
  bool goes_on = takeZero(session, recording);
  std::string answer;
  while (
      goes_on &&
      ask(session, "push, as 5 +y 0.1 or 0 5 0 0.1 (N, m; z: zero anew; enter: end): ", answer)) {
    if (answer.empty()) break;
    if (answer == "z") {
      goes_on = takeZero(session, recording);
      continue;
    }
    KnownPush push;
    std::string problem;
    if (parsePush(answer, session.shape.length_m, push, problem))
      goes_on = takePush(session, push, recording);
    else
      fmt::print(session.out, "{}\n", problem);
  }
  const std::string told =
      recording.pushes().empty() ? "no push yet\n" : toldSoFar(session, recording.pushes());
  fmt::print(session.out, "ended; module {}, {}: {}", escaped(session.link), escaped(session.path),
             told);
}

}  // namespace tactus
