#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>

#include "tactus/cli/commands.h"
#include "tactus/daemon/control_client.h"
#include "tactus/daemon/control_socket.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/number_text.h"
#include "tactus/scene/source_reader.h"
#include "tactus/scene/yaml_tree.h"

/// Where the tool of the running daemon shall go: move, follow, hold.
namespace tactus {
namespace {

constexpr std::chrono::milliseconds kLookAgain{50};
constexpr std::chrono::milliseconds kPostureLook{500};
/// Joints come nearer by turns. Where for as many looks the farthest has not, by 1 % of what was
/// missing, none does.
constexpr int kLooksInVain = 20;
constexpr double kNearer = 0.99;

struct MoveOptions {
  std::optional<std::string> to, rotate;
  std::string waypoints;
  bool is_relative = false, to_posture = false;
  std::optional<double> speed_m_per_s, speed_rad_per_s;
  bool waits = false;
  bool json = false;
};

/// "0.9,-,0.25": a dash stays as it is. An empty text, as of a variable that is not set, is
/// refused, as the arm would move by the rest of the order.
Json vectorOf(const char* option, const std::string& text) {
  if (text.empty())
    throw InputError(
        fmt::format("{}: is empty, expected three numbers, such as 0.9,-,0.25", option));
  Json vector = Json::array();
  std::size_t start = 0;
  while (start <= text.size()) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    const std::string word = text.substr(start, comma - start);
    start = comma + 1;
    if (word == "-") {
      vector.push_back(nullptr);
      continue;
    }
    const std::optional<double> number = finiteNumber(word);
    if (!number)
      throw InputError(fmt::format("{} {}: {} is no number, expected three, such as 0.9,-,0.25",
                                   option, escaped(text), inQuotes(word)));
    vector.push_back(*number);
  }
  if (vector.size() != 3)
    throw InputError(fmt::format("{} {}: has {} numbers, expected three, such as 0.9,-,0.25",
                                 option, escaped(text), vector.size()));
  return vector;
}

Json moveRequest(const MoveOptions& options) {
  Json request = {{"do", "move"}};
  if (options.to) request["to_m"] = vectorOf("--to", *options.to);
  if (options.rotate) request["rotate_rad"] = vectorOf("--rotate", *options.rotate);
  if (options.is_relative) request["relative"] = true;
  if (options.to_posture) request["to_posture"] = true;
  if (options.speed_m_per_s) request["speed_m_per_s"] = *options.speed_m_per_s;
  if (options.speed_rad_per_s) request["speed_rad_per_s"] = *options.speed_rad_per_s;
  return request;
}

/// What a file says, as JSON; whether that is right, the daemon judges.
Json jsonOf(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::kList: {
      Json list = Json::array();
      for (const YamlNode& item : node.items) list.push_back(jsonOf(item));
      return list;
    }
    case YamlNode::Kind::kMap: {
      Json map = Json::object();
      for (const YamlEntry& entry : node.entries) map[entry.key] = jsonOf(entry.value);
      return map;
    }
    case YamlNode::Kind::kScalar: {
      if (node.quoted) return node.text;
      if (const std::optional<double> number = finiteNumber(node.text)) return *number;
      const bool is_flag = node.text == "true" || node.text == "false";
      return is_flag ? Json(node.text == "true") : Json(node.text);
    }
    default:
      return nullptr;
  }
}

std::string contactText(const Json& contact) {
  if (contact.is_null()) return "";
  return fmt::format(
      " by a contact of {:.2f} N on {}, {:.3f} m along it", contact.at("force_N").get<double>(),
      escaped(contact.at("module").get<std::string>()), contact.at("position_m").get<double>());
}

std::string taskText(const Json& task) {
  const auto state = task.at("state").get<std::string>();
  if (state == "moving") return "on its way\n";
  if (state == "arrived") return "arrived\n";
  if (state == "holding") return "holding\n";
  if (state == "blocked") return fmt::format("blocked{}\n", contactText(task.at("contact")));
  if (state == "given_up")
    return fmt::format("given up, was blocked{}\n", contactText(task.at("contact")));
  if (state == "stopped") return "the arm was stopped: `tactus status` says why\n";
  return escaped(state) + "\n";
}

bool isUnderWay(const Json& task) {
  return task.at("state") == "moving" || task.at("state") == "blocked" ||
         task.at("waiting").get<int>() > 0;
}

/// A while later; of another order than ours it says nothing.
Json lookAgain(const ControlClient& daemon, const Json& task, std::chrono::milliseconds later) {
  std::this_thread::sleep_for(later);
  Json now = daemon.ask({{"do", "show"}}).at("task");
  if (now.at("number") != task.at("number"))
    throw InputError("another order has taken the place of this one");
  return now;
}

/// The task's last state.
Json waitFor(const ControlClient& daemon, Json task) {
  while (isUnderWay(task)) task = lookAgain(daemon, task, kLookAgain);
  return task;
}

/// The task's last state, once all joints are in the posture, or come no nearer.
Json waitForPosture(const ControlClient& daemon, Json task) {
  double nearest = std::numeric_limits<double>::infinity();
  int in_vain = 0;
  while (task.at("state") == "arrived" && !task.at("posture").at("is_there") &&
         in_vain < kLooksInVain) {
    const auto away = task.at("posture").at("away").get<double>();
    in_vain = away < kNearer * nearest ? 0 : in_vain + 1;
    if (in_vain == 0) nearest = away;
    task = lookAgain(daemon, task, kPostureLook);
  }
  return task;
}

std::string postureText(const Json& posture) {
  if (posture.at("is_there")) return "in the posture\n";
  return fmt::format("not in the posture: {} is {:.3g} {} away\n",
                     escaped(posture.at("joint").get<std::string>()),
                     posture.at("away").get<double>(), posture.at("unit").get<std::string>());
}

int tell(const Json& request, const MoveOptions& options) {
  const ControlClient daemon(controlPath());
  Json task = daemon.ask(request).at("task");
  const bool waits_for_posture = options.waits && options.to_posture;
  if (options.waits) task = waitFor(daemon, std::move(task));
  if (waits_for_posture) task = waitForPosture(daemon, std::move(task));
  std::string text = options.json ? jsonText(task) : taskText(task);
  if (waits_for_posture && !options.json) text += postureText(task.at("posture"));
  std::fputs(text.c_str(), stdout);
  const bool is_well = task.at("state") != "given_up" && task.at("state") != "stopped" &&
                       (!waits_for_posture || task.at("posture").at("is_there"));
  return is_well ? kExitDone : kExitFault;
}

CLI::App* addOrder(CLI::App& app, const char* name, const char* help, MoveOptions& options) {
  CLI::App* command = app.add_subcommand(name, help);
  command->add_flag("--json", options.json, "Print JSON");
  return command;
}

}  // namespace

void addMoveCommand(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<MoveOptions>();
  CLI::App* const command =
      addOrder(app, "move", "Tell the tool of the running daemon where to go", *options);
  // CLI11 would take an empty text for an absent one.
  command->add_option_function<std::string>(
      "--to", [options](const std::string& text) { options->to = text; },
      "X,Y,Z in m, base frame; - for one that stays");
  command->add_option_function<std::string>(
      "--rotate", [options](const std::string& text) { options->rotate = text; },
      "RX,RY,RZ in rad: axis times angle, base frame");
  command->add_flag("--relative", options->is_relative, "Both from where the tool is");
  command->add_flag("--to-posture", options->to_posture,
                    "To where it is in redundancy.posture; with --wait until all joints are there");
  command->add_option("--speed", options->speed_m_per_s, "At most so many m/s");
  command->add_option("--turn-speed", options->speed_rad_per_s, "At most so many rad/s");
  command->add_flag("--wait", options->waits, "Until it has arrived, or given up");
  command->callback([options, &exit_code] { exit_code = tell(moveRequest(*options), *options); });
}

void addFollowCommand(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<MoveOptions>();
  CLI::App* command =
      addOrder(app, "follow", "Lead the tool of the running daemon along waypoints", *options);
  command->add_option("waypoints", options->waypoints, "YAML: a list of what move is told")
      ->required();
  command->add_flag("--wait", options->waits, "Until it has arrived at the last, or given up");
  command->callback([options, &exit_code] {
    const std::string& path = options->waypoints;
    const Json waypoints = jsonOf(parseYaml(SourceReader(readFromDisk).readFirst(path)));
    exit_code = tell({{"do", "follow"}, {"waypoints", waypoints}}, *options);
  });
}

void addHoldCommand(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<MoveOptions>();
  CLI::App* command =
      addOrder(app, "hold", "Stop the tool of the running daemon where it is", *options);
  command->callback([options, &exit_code] { exit_code = tell({{"do", "hold"}}, *options); });
}

}  // namespace tactus
