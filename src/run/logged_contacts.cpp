#include "tactus/run/logged_contacts.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tactus/record/contact_json.h"
#include "tactus/record/contact_watch.h"
#include "tactus/record/log_parts.h"
#include "tactus/record/logged_scene.h"
#include "tactus/record/ulog_reader.h"

namespace tactus {
namespace {

Scene sceneOfLog(std::ifstream& file, const std::string& path) {
  Scene scene = loggedScene(UlogReader(file, path), path);
  file.clear();
  file.seekg(0);
  return scene;
}

}  // namespace

LoggedContacts readContacts(const std::vector<std::string>& paths) {
  std::vector<std::ifstream> files = openLogs(paths);
  LoggedContacts logged{.scene = sceneOfLog(files.back(), paths.back()), .contacts = {}};
  ContactWatch watch(logged.scene.controller);
  const auto keep = [&](const std::vector<ContactFigures>& contacts) {
    logged.contacts.insert(logged.contacts.end(), contacts.begin(), contacts.end());
  };
  LogPart before;
  CycleRecord record;
  bool is_empty = true;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    UlogReader reader(files[i], paths[i]);
    reader.assumeGains(logged.scene.controller.gains);
    const LogPart part = logPart(reader.description(), paths[i]);
    if (i > 0) checkOrder(paths[i], part, paths[i - 1], before);
    before = part;
    if (i == 0) logged.first_part = part.part;
    for (; reader.next(record); is_empty = false) {
      if (is_empty) logged.begin_s = record.t_s;
      keep(watch.add(record));
    }
    logged.is_cut_off = reader.cutOff();
  }
  if (is_empty) refuseEmptyLog(paths.back());
  keep(watch.present());
  std::ranges::stable_sort(logged.contacts, {}, &ContactFigures::start_s);
  return logged;
}

Json contactsJson(const LoggedContacts& logged) {
  Json json = Json::array();
  for (const ContactFigures& contact : logged.contacts)
    json.push_back(contactJson(contact, logged.scene.module_links));
  return json;
}

}  // namespace tactus
