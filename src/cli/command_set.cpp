#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tactus/cli/commands.h"
#include "tactus/daemon/control_client.h"
#include "tactus/daemon/control_requests.h"
#include "tactus/daemon/control_socket.h"
#include "tactus/daemon/gain_save.h"
#include "tactus/daemon/number_within.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/scene_loader.h"

/// The gains of the running daemon: set, reload, undo, diff, save.
namespace tactus {
namespace {

struct ChangeOptions {
  std::vector<std::string> settings;
  std::optional<double> for_s;
  bool waits = false;
  bool json = false;
};

std::string wordAt(const Json& answer, const char* name) {
  return escaped(answer.at(name).get<std::string>());
}

/// "controller.damping  0.5 -> 0.6", a line a key.
std::string changeText(const Json& answer) {
  std::string text;
  for (const auto& [key, values] : answer.at("changes").items())
    text += fmt::format("{}  {} -> {}\n", escaped(key), values.at("from").dump(),
                        values.at("to").dump());
  return text;
}

std::string stateText(const Json& answer) {
  const std::string state = wordAt(answer, "state"), trouble = wordAt(answer, "trouble");
  if (state == "waiting") return "waits for a moment without contact\n";
  if (state == "ramping") return "on its way\n";
  if (state == "on_trial") return "there, and watched in contact; `tactus undo` goes back\n";
  if (state == "going_back") return fmt::format("going back: {}\n", trouble);
  if (!trouble.empty()) return fmt::format("gone back: {}\n", trouble);
  return "kept\n";
}

std::string answerText(const Json& answer) {
  const bool differs = !answer.at("changes").empty();
  const bool has_trouble = !answer.at("trouble").get<std::string>().empty();
  std::string text = differs ? changeText(answer) : "nothing differs\n";
  if (differs || has_trouble) text += stateText(answer);
  if (answer.at("is_for_a_time"))
    text += "for a time: then back to what was kept before, with what is still on trial\n";
  return text;
}

int change(const Json& request, const ChangeOptions& options) {
  const Json answer = ControlClient(controlPath()).change(request, options.waits);
  std::fputs((options.json ? jsonText(answer) : answerText(answer)).c_str(), stdout);
  return answer.at("trouble").get<std::string>().empty() ? kExitDone : kExitFault;
}

/// A word as it stands in YAML: a number is one, everything else a word.
Json valueOf(const std::string& text) {
  if (text == "~" || text == "null") return nullptr;
  const Json number = Json::parse(text, nullptr, false);
  return number.is_number() ? number : Json(text);
}

Json setRequest(const ChangeOptions& options) {
  Json request = {{"do", "set"}, {"values", Json::object()}};
  for (const std::string& text : options.settings) {
    const Override setting = parseOverride(text);
    const auto [place, is_new] = request["values"].emplace(setting.key, valueOf(setting.value));
    if (!is_new) failAt(beginOf("set"), setting.key, "is given twice", "expected each key once");
  }
  if (options.for_s) request["for_s"] = *options.for_s;
  return request;
}

int diff(const ChangeOptions& options) {
  const Json answer = ControlClient(controlPath()).ask({{"do", "show"}});
  const auto path = answer.at("scene").get<std::string>();
  const Json differing = gainDifferences(path, answer.at("ordered"));
  if (options.json) {
    std::fputs(jsonText(differing).c_str(), stdout);
    return kExitDone;
  }
  for (const auto& [key, values] : differing.items())
    fmt::print("{}  {} in {}, {} running\n", key, values.at("file").dump(), escaped(path),
               values.at("running").dump());
  if (differing.empty()) fmt::print("as in {}\n", escaped(path));
  return kExitDone;
}

int save(bool as_json) {
  const SavedGains saved = saveGains(ControlClient(controlPath()));
  if (as_json)
    std::fputs(jsonText({{"scene", saved.path}, {"written", saved.is_new}}).c_str(), stdout);
  else if (saved.is_new)
    fmt::print("{} written, as it was is {}~\n", escaped(saved.path), escaped(saved.path));
  else
    fmt::print("{} has all that runs\n", escaped(saved.path));
  if (!as_json && saved.state == "waiting")
    fmt::print("these gains still wait for a moment without contact\n");
  else if (!as_json && saved.state != "kept")
    fmt::print("these gains are still on trial: `tactus diff` shows whether they go back\n");
  return kExitDone;
}

CLI::App* addChange(CLI::App& app, const char* name, const char* help, ChangeOptions& options) {
  CLI::App* command = app.add_subcommand(name, help);
  command->add_flag("--wait", options.waits, "Until the change is kept, or has gone back");
  command->add_flag("--json", options.json, "Print JSON");
  return command;
}

}  // namespace

void addSetCommand(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ChangeOptions>();
  CLI::App* command = addChange(app, "set", "Change gains of the running daemon", *options);
  command->add_option("KEY=VALUE", options->settings, "All of these, or none")->required();
  command->add_option("--for", options->for_s, "Go back after so many seconds")
      ->check(numberWithin(kMinFor_s, kMaxFor_s));
  command->callback([options, &exit_code] { exit_code = change(setRequest(*options), *options); });
}

void addReloadCommand(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ChangeOptions>();
  CLI::App* command =
      addChange(app, "reload", "Take the gains of the daemon's scene file anew", *options);
  command->callback([options, &exit_code] { exit_code = change({{"do", "reload"}}, *options); });
}

void addUndoCommand(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ChangeOptions>();
  CLI::App* command = addChange(app, "undo", "Take back the last change of gains", *options);
  command->callback([options, &exit_code] { exit_code = change({{"do", "undo"}}, *options); });
}

void addSaveCommand(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ChangeOptions>();
  CLI::App* command =
      app.add_subcommand("save", "Write the gains that run into the daemon's scene file");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &exit_code] { exit_code = save(options->json); });
}

void addDiffCommand(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<ChangeOptions>();
  CLI::App* command =
      app.add_subcommand("diff", "Show which gains run that the scene file does not have");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &exit_code] { exit_code = diff(*options); });
}

}  // namespace tactus
