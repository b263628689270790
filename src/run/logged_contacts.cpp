#include "tactus/run/logged_contacts.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tactus/record/contact_json.h"
#include "tactus/record/contact_watch.h"
#include "tactus/record/logged_scene.h"
#include "tactus/record/ulog_reader.h"

namespace tactus {
namespace {

/// Reads all cycles of a log; true if it was cut off.
template <class Sink>
bool readCycles(const std::string& path, const Gains& gains, const Sink& sink) {
  std::ifstream in = openLog(path);
  UlogReader reader(in, path);
  reader.assumeGains(gains);
  CycleRecord record;
  while (reader.next(record)) sink(record);
  return reader.cutOff();
}

Scene sceneOfLog(const std::string& path) {
  std::ifstream in = openLog(path);
  return loggedScene(UlogReader(in, path), path);
}

}  // namespace

LoggedContacts readContacts(const std::string& path) {
  checkLog(path);
  LoggedContacts logged{.scene = sceneOfLog(path), .contacts = {}};
  ContactWatch watch(logged.scene.controller);
  const auto keep = [&](const std::vector<ContactFigures>& contacts) {
    logged.contacts.insert(logged.contacts.end(), contacts.begin(), contacts.end());
  };
  logged.is_cut_off = readCycles(path, logged.scene.controller.gains,
                                 [&](const CycleRecord& record) { keep(watch.add(record)); });
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
