#include <fmt/format.h>

#include <utility>
#include <vector>

#include "model/mode_model.h"

/// Modes and faults in words.
namespace tactus::model {
namespace {

struct Phrase {
  std::uint32_t conditions;
  const char* words;
};

/// Where several phrases fit, the first.
constexpr Phrase kPhrases[] = {
    {kIfEnableLine | kIfEnableOn | kIfWasOff, "enable line off and on"},
    {kIfStopRequested, "stop requested"},
    {kIfEnableOn, "enable line on, or none"},
    {kIfEnableOff, "enable line off"},
    {kIfConfigured, "drives configured, modules tared"},
    {kIfFollowing, "drives follow"},
    {kIfBrakesHadTime, "brakes open"},
    {kIfOffOrTimeOver, "drives off or time over"},
    {kIfTimeOver, "time over"},
    {kIfRetreatOver, "out of the contact"},
    {kIfFault, "a fault"},
    {kIfRetreats, "a fault that retreats"},
    {kIfRamps, "a fault that ramps"},
    {kIfStopsAtOnce, "a fault that stops at once"},
    {kIfNoEnableLine, "no enable line"},
    {kIfAtRest, "at rest"},
    {kIfDrivesOff, "drives off"},
    {kIfCauseGone, "cause gone"},
};

std::string rowWords(const ModeRow& row) {
  std::string words;
  std::uint32_t left = row.conditions;
  for (const Phrase& phrase : kPhrases) {
    if ((left & phrase.conditions) != phrase.conditions) continue;
    left &= ~phrase.conditions;
    words += (words.empty() ? "" : ", ") + std::string(phrase.words);
  }
  if (left != 0) words += fmt::format(" and what has no words: {:#x}", left);
  if (row.time_limit == Fault::kNone) return words;
  return fmt::format("{} ({})", words, faultName(row.time_limit));
}

/// A change of mode with all that leads to it.
struct Change {
  Mode from, to;
  std::string when;
};

std::vector<Change> changes() {
  std::vector<Change> all;
  for (const ModeRow& row : modeRows()) {
    if (row.from == row.to) continue;
    const bool is_more = !all.empty() && all.back().from == row.from && all.back().to == row.to;
    if (is_more)
      all.back().when += "; " + rowWords(row);
    else
      all.push_back({row.from, row.to, rowWords(row)});
  }
  return all;
}

/// What is typed is bold, with the keyboard's hyphens.
std::string manualText(const char* text) {
  std::string manual;
  bool is_typed = false;
  for (; *text != '\0'; ++text) {
    if (*text == '`')
      manual += (is_typed = !is_typed) ? "\\fB" : "\\fR";
    else
      manual += is_typed && *text == '-' ? "\\-" : std::string(1, *text);
  }
  return manual;
}

}  // namespace

std::string modeTable() {
  std::string text = "| From | To | When |\n|---|---|---|\n";
  for (const Change& change : changes())
    text +=
        fmt::format("| {} | {} | {} |\n", modeName(change.from), modeName(change.to), change.when);
  return text;
}

std::string modeManual() {
  std::string text;
  const char* before = "";
  for (const Change& change : changes()) {
    const char* from = modeName(change.from);
    text += std::exchange(before, from) == from ? ".br\n" : fmt::format(".TP\n.B {}\n", from);
    text += fmt::format("to {}: {}\n", modeName(change.to), change.when);
  }
  return text;
}

std::string remedyTable() {
  std::string text = "| Fault | Before going on |\n|---|---|\n";
  for (const FaultRow& row : faultTable())
    if (row.fault != Fault::kNone) text += fmt::format("| `{}` | {} |\n", row.name, row.remedy);
  return text;
}

std::string faultManual() {
  std::string text;
  for (const FaultRow& row : faultTable())
    if (row.fault != Fault::kNone)
      text += fmt::format(".TP\n.B {}\n{}; {}; {}; {}\n.br\nBefore going on: {}\n", row.name,
                          row.detection, row.within, reactionName(row.reaction), row.remains,
                          manualText(row.remedy));
  return text;
}

}  // namespace tactus::model
