#include "tactus/daemon/gain_save.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tactus/record/output_file.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/gain_keys.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/scene_loader.h"
#include "tactus/scene/source_hash.h"
#include "tactus/scene/source_reader.h"
#include "tactus/scene/yaml_edit.h"

namespace tactus {
namespace {

/// The scene file with the gains that run, all else of it as it is.
std::string withGains(const std::string& path, std::string text, const Json& running) {
  const Json differing = gainDifferences(path, running);
  for (const auto& [key, values] : differing.items()) {
    const Json& value = values.at("running");
    text = withValue({path, text}, key, value.is_null() ? "~" : value.dump());
  }
  return text;
}

/// Whatever was changed: what is written has to be read as what runs.
void checkGains(const std::string& path, const Json& running) {
  const Json differing = gainDifferences(path, running);
  if (!differing.empty())
    throw RunError(
        fmt::format("{}: {} could not be written", escaped(path), differing.items().begin().key()));
}

/// The daemon reads what was written. Gains that went back meanwhile may not return by that, nor
/// stay in the file.
void takeNote(const ControlClient& daemon, const std::string& path, const std::string& before) {
  try {
    daemon.ask({{"do", "reload"}, {"only_read", true}});
  } catch (const InputError& refused) {
    replaceWithoutCopy(path, before);
    throw RunError(fmt::format("{}: is as it was, for what runs was changed meanwhile: {}",
                               escaped(path), refused.what()));
  } catch (const RunError& error) {
    throw RunError(fmt::format(
        "{}: is written, but the daemon may not have read it: {}; `tactus reload` lets it",
        escaped(path), error.what()));
  }
}

}  // namespace

Json gainDifferences(const std::string& path, const Json& running) {
  const Gains in_file = loadScene(path, {}).controller.gains;
  Json differing = Json::object();
  for (const GainKey& key : gainKeys()) {
    const Json file = gainAt(in_file, key.offset);
    const Json& now = running.at(key.path);
    if (file.dump() != now.dump()) differing[key.path] = {{"file", file}, {"running", now}};
  }
  return differing;
}

SavedGains saveGains(const ControlClient& daemon) {
  const Json answer = daemon.ask({{"do", "show"}});
  if (answer.at("is_for_a_time"))
    throw InputError(
        "save: gains are set for a time, and go back after it; expected them to be set without "
        "--for, once they are back");
  const std::string path = answer.at("scene");
  const std::string text = SourceReader(readFromDisk).readFirst(path).text;
  if (fmt::format("{:016x}", sourceHash(text)) != answer.at("scene_hash"))
    throw InputError(
        fmt::format("{}: was changed since the daemon read it, expected no change; "
                    "`tactus diff` shows what differs, `tactus reload` takes it",
                    escaped(path)));
  const std::string state = answer.at("state");
  const std::string changed = withGains(path, text, answer.at("ordered"));
  if (changed == text) return {path, false, state};
  replaceFile(path, changed,
              [&](const std::string& next) { checkGains(next, answer.at("ordered")); });
  takeNote(daemon, path, text);
  return {path, true, state};
}

}  // namespace tactus
