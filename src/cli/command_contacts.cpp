#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <istream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tactus/cli/commands.h"
#include "tactus/daemon/running_log.h"
#include "tactus/record/contact_figures.h"
#include "tactus/record/contact_json.h"
#include "tactus/record/contact_watch.h"
#include "tactus/record/growing_file.h"
#include "tactus/record/log_parts.h"
#include "tactus/record/logged_scene.h"
#include "tactus/record/ulog_reader.h"
#include "tactus/run/logged_contacts.h"
#include "tactus/scene/located_error.h"

/// The contacts of a run, a row each.
namespace tactus {
namespace {

Scene loadLogged(const std::string& path) {
  std::ifstream in = openLog(path);
  return loggedScene(UlogReader(in, path), path);
}

std::string swingText(const ContactFigures& contact) {
  constexpr double kRests_N = 0.1;
  if (std::isnan(contact.swing_N)) return "-";
  if (contact.swing_N < kRests_N) return "rests";
  if (contact.swing_hz == 0.0) return fmt::format("{:.2f}, moves", contact.swing_N);
  return fmt::format("{:.2f} at {:.1f} Hz", contact.swing_N, contact.swing_hz);
}

std::string shareText(double share) {
  return std::isnan(share) ? "-" : fmt::format("{:.0f}", 100.0 * share);
}

std::string restText(const ContactFigures& contact) {
  return std::isnan(contact.rest_force_N) ? "-" : fmt::format("{:.2f}", contact.rest_force_N);
}

/// c_e with its interval.
std::string stiffnessText(const TouchFit& touch) {
  if (!touch.is_known) return "-";
  return fmt::format("{:.0f} ({:.0f}..{:.0f})", touch.stiffness_N_per_m, touch.low_N_per_m,
                     touch.high_N_per_m);
}

std::string headerText() {
  return fmt::format(
      "{:>8} {:>8} {:<10} {:>6} {:>7} {:>7} {:>7} {:>7} {:<15} {:>9} {:<20} {:>6} {:>5} {:>5} "
      "{:>6} {:>5}\n",
      "start_s", "end_s", "link", "x_mm", "peak_N", "above_s", "rests_s", "rest_N", "swing_N",
      "c, N/m", "c_e, N/m (95 %)", "tcp_mm", "null%", "task%", "T_s", "d");
}

std::string contactText(const Scene& scene, const ContactFigures& contact) {
  return fmt::format(
      "{:8.3f} {:8.3f} {:<10} {:6.0f} {:7.2f} {:7.3f} {:7.3f} {:>7} {:<15} {:9.0f} {:<20} "
      "{:6.1f} {:5.0f} {:>5} {:6.3g} {:5.3g}\n",
      contact.start_s, contact.end_s, escaped(linkOfModule(scene.module_links, contact.module)),
      1e3 * contact.position_m, contact.peak_force_N, contact.time_above_s, contact.settling_s,
      restText(contact), swingText(contact), contact.stiffness_N_per_m,
      stiffnessText(contact.touch), 1e3 * contact.tcp_error_max_m, 100.0 * contact.null_share,
      shareText(contact.task_share), contact.gains.force.time_constant_s,
      contact.gains.force.damping);
}

std::string contactsText(const LoggedContacts& logged) {
  if (logged.contacts.empty()) return "no contact\n";
  std::string text = headerText();
  for (const ContactFigures& contact : logged.contacts) text += contactText(logged.scene, contact);
  return text;
}

void printContacts(const Scene& scene, const std::vector<ContactFigures>& contacts, bool as_json) {
  for (const ContactFigures& contact : contacts) {
    const std::string line = as_json ? contactJson(contact, scene.module_links).dump() + "\n"
                                     : contactText(scene, contact);
    std::fputs(line.c_str(), stdout);
  }
  if (!contacts.empty()) std::fflush(stdout);
}

/// Each contact when it is over, of those that were there already and of those that come.
void followContacts(const std::string& path, bool as_json) {
  const Scene scene = loadLogged(path);
  ContactWatch watch(scene.controller);
  std::optional<std::string> run;
  if (!as_json) std::fputs(headerText().c_str(), stdout);
  std::fflush(stdout);
  for (bool goes_on = true; goes_on;) {
    GrowingFile file(path);
    std::istream in(&file);
    UlogReader reader(in, path);
    if (!isOfRun(reader.description(), path, run)) break;
    reader.assumeGains(scene.controller.gains);
    CycleRecord record;
    while (reader.next(record)) printContacts(scene, watch.add(record), as_json);
    goes_on = file.goesOn();
  }
  printContacts(scene, watch.present(), as_json);
}

}  // namespace

void addContactsCommand(CLI::App& app, int& exit_code) {
  struct ContactsOptions {
    std::string log;
    bool follows = false;
    bool json = false;
  };
  const auto options = std::make_shared<ContactsOptions>();
  CLI::App* const command =
      app.add_subcommand("contacts", "Show each contact of a run, a row each");
  command->add_option("log", options->log,
                      "Log of a run (run.ulg); else that of the daemon that runs");
  command->add_flag("--follow", options->follows, "Go on with those that come, until the run ends");
  command->add_flag("--json", options->json, "Print JSON; with --follow an object a line");
  command->callback([options, &exit_code] {
    exit_code = kExitDone;
    if (options->log.empty()) options->log = runningLog();
    if (options->follows) return followContacts(options->log, options->json);
    const LoggedContacts logged = readContacts(options->log);
    if (logged.is_cut_off) fmt::print(stderr, "{}: the log was cut off\n", escaped(options->log));
    std::fputs((options->json ? jsonText(contactsJson(logged)) : contactsText(logged)).c_str(),
               stdout);
  });
}

}  // namespace tactus
