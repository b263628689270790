#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <vector>

#include "model/mode_model.h"
#include "model/promela_texts.h"
#include "support/mode_walk.h"

/// Writes the model: what the tables say from the tables, what must hold by hand.
namespace tactus::model {
namespace {

/// In the order of test::walkInput().
constexpr const char* kInputs[] = {"enable",     "stop",         "configured", "following",
                                   "drives_off", "at_rest",      "resting",    "any_holds",
                                   "moving_on",  "retreat_over", "missed"};

/// Of a condition, with the input that it looks at, if any.
struct Expression {
  std::uint32_t condition;
  const char* promela;  ///< {} is the mode's time limit
  const char* input = "";
};

constexpr Expression kModeExpressions[] = {
    {kIfStopRequested, "stop", "stop"},
    {kIfEnableOn, "enable"},
    {kIfEnableOff, "!enable"},
    {kIfEnableLine, "has_line"},
    {kIfNoEnableLine, "!has_line"},
    {kIfConfigured, "configured", "configured"},
    {kIfFollowing, "following", "following"},
    {kIfNotFollowing, "!following", "following"},
    {kIfBrakesHadTime, "enabled_cycles >= BRAKE_CYCLES"},
    {kIfAtRest, "at_rest", "at_rest"},
    {kIfDrivesOff, "drives_off", "drives_off"},
    {kIfOffOrTimeOver, "(drives_off || cycles > {})", "drives_off"},
    {kIfTimeOver, "cycles > {}"},
    {kIfRetreatOver, "retreat_over", "retreat_over"},
    {kIfFault, "fault != NO_FAULT"},
    {kIfRetreats, "reaction == RETREAT"},
    {kIfRamps, "reaction == RAMP"},
    {kIfStopsAtOnce, "reaction >= QUICK_STOP"},
    {kIfCauseGone, "seen == NO_FAULT"},
    {kIfWasOff, "may_clear"},
};

constexpr Expression kBrakeExpressions[] = {
    {kIfBrakeWasOpen, "is_open"},
    {kIfAllFollow, "following", "following"},
    {kIfNotResting, "rest_cycles == 0", "resting"},
    {kIfAnyHolds, "any_holds", "any_holds"},
    {kIfNoneMovesOn, "!moving_on", "moving_on"},
    {kIfBeforeDeadline, "cycles < DEADLINE_CYCLES"},
};

std::string upper(std::string text) {
  for (char& c : text) c = c == ' ' ? '_' : static_cast<char>(std::toupper(c));
  return text;
}
std::string name(Mode mode) { return upper(modeName(mode)); }
std::string name(Fault fault) {
  return fault == Fault::kNone ? "NO_FAULT" : upper(faultName(fault));
}
std::string name(Reaction reaction) {
  constexpr const char* kNames[] = {"NO_REACTION", "RETREAT", "RAMP", "QUICK_STOP", "BRAKE"};
  return kNames[static_cast<int>(reaction)];
}

std::string expression(std::uint32_t conditions, std::span<const Expression> all, Mode mode) {
  const std::string limit = name(mode == Mode::kFault ? Mode::kStopping : mode) + "_CYCLES";
  std::string text;
  for (const Expression& one : all) {
    if ((conditions & one.condition) == 0) continue;
    text += (text.empty() ? "" : " && ") + fmt::format(fmt::runtime(one.promela), limit);
  }
  return text.empty() ? "true" : text;
}

std::string define(const std::string& what, int value) {
  return fmt::format("#define {} {}\n", what, value);
}

std::string definitions() {
  std::string text;
  for (int i = 0; i < kModeCount; ++i) text += define(name(static_cast<Mode>(i)), i);
  for (int i = 0; i <= static_cast<int>(Reaction::kBrake); ++i)
    text += define(name(static_cast<Reaction>(i)), i);
  for (const FaultRow& row : faultTable())
    if (representative(row.fault) == row.fault)
      text += define(name(row.fault), static_cast<int>(row.fault));
  text += define("BOOT_CYCLES", test::kWalkModes.boot_cycles);
  text += define("ENABLING_CYCLES", test::kWalkModes.enabling_cycles);
  text += define("RETREATING_CYCLES", test::kWalkModes.retreating_cycles);
  text += define("STOPPING_CYCLES", test::kWalkModes.stopping_cycles);
  text += define("BRAKE_CYCLES", test::kWalkModes.brake_cycles);
  text += define("REST_CYCLES", test::kWalkBrakes.rest_cycles);
  text += define("DEADLINE_CYCLES", test::kWalkBrakes.deadline_cycles);
  text += define("LONGEST_CYCLES", test::kWalkLongest_cycles);
  text += define("RAMP_CYCLES", test::kWalkRamp_cycles);
  text += define("MISSED_CYCLES", test::kWalkMissed_cycles);
  return text;
}

std::string rowEffects(const ModeRow& row) {
  std::string text;
  if (row.time_limit != Fault::kNone)
    text += fmt::format("note({}, {}); ", name(row.time_limit),
                        name(faultRow(row.time_limit).reaction));
  if (row.effect == ModeEffect::kCountFollowing) text += "enabled_cycles++";
  if (row.effect == ModeEffect::kCountAnew) text += "enabled_cycles = 0";
  if (row.effect == ModeEffect::kRememberOff) text += "may_clear = true";
  if (row.effect == ModeEffect::kClear) text += "acknowledge(); ";
  return row.from == row.to ? text : text + fmt::format("enter({})", name(row.to));
}

/// A mode's rows, the first that holds.
std::string modeStep(Mode mode) {
  std::string text = fmt::format("  :: mode == {} ->\n", name(mode));
  int rows = 0;
  for (const ModeRow& row : modeRows()) {
    if (row.from != mode) continue;
    text += fmt::format("    {}if\n    :: {} -> {}\n", rows++ == 0 ? "" : ":: else -> ",
                        expression(row.conditions, kModeExpressions, mode), rowEffects(row));
  }
  if (rows == 0) return text + "    skip\n";
  text += "    :: else -> skip\n    ";
  for (int i = 0; i < rows; ++i) text += i + 1 == rows ? "fi\n" : "fi ";
  return text;
}

void addInputs(std::uint32_t conditions, std::span<const Expression> all,
               std::vector<std::string>& inputs) {
  for (const Expression& one : all)
    if ((conditions & one.condition) != 0) inputs.emplace_back(one.input);
}

/// What a mode's rows look at, and those of the brakes in any mode that comes next: all that
/// matters.
std::string modeInputs(Mode mode) {
  std::vector<std::string> inputs;
  for (const ModeRow& row : modeRows())
    if (row.from == mode) addInputs(row.conditions, kModeExpressions, inputs);
  for (const BrakeRow& row : brakeRows())
    if (row.mode == mode || isLegal(mode, row.mode))
      addInputs(row.conditions, kBrakeExpressions, inputs);
  if (test::countsMissedCycles(mode)) inputs.emplace_back("missed");
  std::string text = fmt::format("    :: mode == {} ->\n      skip", name(mode));
  for (const char* input : kInputs) {
    if (std::count(inputs.begin(), inputs.end(), input) == 0) continue;
    const std::string macro = std::string_view(input) == "at_rest"     ? "choose_at_rest()"
                              : std::string_view(input) == "any_holds" ? "choose_any_holds()"
                                                                       : "";
    text += "; " + (macro.empty() ? fmt::format("choose({})", input) : macro);
  }
  return text + "\n";
}

std::string brakeSteps() {
  std::string text;
  for (const BrakeRow& row : brakeRows())
    text += fmt::format("  :: reaction != BRAKE && mode == {} ->\n    is_open = ({})\n",
                        name(row.mode), expression(row.conditions, kBrakeExpressions, row.mode));
  return text;
}

std::string faultChoices() {
  std::string text;
  for (const FaultRow& row : faultTable())
    if (representative(row.fault) == row.fault)
      text += fmt::format("    :: seen = {}; seen_reaction = {}\n", name(row.fault),
                          name(row.reaction));
  return text;
}

std::string eachMode(std::string (*write)(Mode mode)) {
  std::string text;
  for (int i = 0; i < kModeCount; ++i) text += write(static_cast<Mode>(i));
  return text;
}

std::string filled(std::string text, const std::string& mark, const std::string& with) {
  return text.replace(text.find(mark), mark.size(), with);
}

}  // namespace

Fault representative(Fault fault) {
  for (const ModeRow& row : modeRows())
    if (row.time_limit == fault) return fault;
  for (const FaultRow& row : faultTable())
    if (row.reaction == faultRow(fault).reaction) return row.fault;
  return fault;
}

std::string promelaModel() {
  std::string text =
      "/* Modes, faults and brakes for SPIN. Written by tests/model/mode_model_test.py --write "
      "from\n"
      "   the tables that the daemon runs from, src/supervisor/mode_table.cpp and\n"
      "   src/control/fault.cpp; with time limits of a few cycles. Of faults with the same "
      "reaction\n"
      "   there is one: the test shows that the code treats the others alike. */\n\n";
  text += definitions() + kStateText;
  text += "\ninline update_mode() {\n  if\n" + eachMode(modeStep) + "  fi\n}\n";
  text +=
      "\ninline update_brake() {\n"
      "  if\n"
      "  :: mode == STOPPING && resting ->\n"
      "    if\n"
      "    :: rest_cycles <= REST_CYCLES -> rest_cycles++\n"
      "    :: else -> skip\n"
      "    fi\n"
      "  :: else -> rest_cycles = 0\n"
      "  fi;\n"
      "  if\n" +
      brakeSteps() + "  :: else -> is_open = false\n  fi\n}\n";
  text += kClaimsText;
  return text +
         filled(filled(kCycleText, "{faults}", faultChoices()), "{inputs}", eachMode(modeInputs));
}

}  // namespace tactus::model
