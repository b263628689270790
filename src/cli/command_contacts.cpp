#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <istream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tactus/cli/commands.h"
#include "tactus/daemon/named_file.h"
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

/// c, of an arm with several modules if this one ever felt most.
std::string lawStiffnessText(const ContactFigures& contact) {
  const double c_N_per_m = contact.stiffness_N_per_m;
  return std::isnan(c_N_per_m) ? "-" : fmt::format("{:.0f}", c_N_per_m);
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
      "{:8.3f} {:8.3f} {:<10} {:6.0f} {:7.2f} {:7.3f} {:7.3f} {:>7} {:<15} {:>9} {:<20} "
      "{:6.1f} {:5.0f} {:>5} {:6.3g} {:5.3g}\n",
      contact.start_s, contact.end_s, escaped(linkOfModule(scene.module_links, contact.module)),
      1e3 * contact.position_m, contact.peak_force_N, contact.time_above_s, contact.settling_s,
      restText(contact), swingText(contact), lawStiffnessText(contact),
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

/// A contact at the begin of an older file that is not there would pass for a touch without a peak.
void tellOfBegin(const std::string& path, int part, double begin_s) {
  if (part > 0)
    fmt::print(stderr,
               "{}: begins at {:.3f} s of the run: what was before is not in it, nor counts for a "
               "contact of then\n",
               escaped(path), begin_s);
}

void printContacts(const Scene& scene, const std::vector<ContactFigures>& contacts, bool as_json) {
  for (const ContactFigures& contact : contacts) {
    const std::string line = as_json ? contactJson(contact, scene.module_links).dump() + "\n"
                                     : contactText(scene, contact);
    std::fputs(line.c_str(), stdout);
  }
  if (!contacts.empty()) std::fflush(stdout);
}

/// Prints each contact when it is over.
class ContactPrinter {
 public:
  ContactPrinter(const std::string& path, bool as_json)
      : path_(path), scene_(loadLogged(path)), watch_(scene_.controller), as_json_(as_json) {
    if (!as_json) std::fputs(headerText().c_str(), stdout);
    std::fflush(stdout);
  }

  /// Of the older files of the run, what was not read yet.
  void readOlder() {
    std::vector<std::string> paths = logsOfRun(path_);
    paths.pop_back();
    std::vector<std::ifstream> files = openLogs(paths);
    for (std::size_t i = 0; i < paths.size(); ++i) {
      UlogReader reader(files[i], paths[i]);
      if (logPart(reader.description(), paths[i]).part >= next_part_) read(reader);
    }
  }

  void follow(bool whole_run) {
    if (whole_run) readOlder();
    for (bool goes_on = true; goes_on;) {
      GrowingFile file(path_);
      std::istream in(&file);
      UlogReader reader(in, path_);
      // One that was begun and renamed meanwhile lies among the older ones.
      const int part = logPart(reader.description(), path_).part;
      if (part > next_part_ && (whole_run || next_part_ > 0)) readOlder();
      if (part < next_part_ || !read(reader)) break;
      goes_on = file.goesOn();
    }
    printContacts(scene_, watch_.present(), as_json_);
  }

 private:
  /// False: it is of another run.
  bool read(UlogReader& reader) {
    const bool is_first = !run_;
    if (!isOfRun(reader.description(), path_, run_)) return false;
    const int part = logPart(reader.description(), path_).part;
    next_part_ = part + 1;
    reader.assumeGains(scene_.controller.gains);
    CycleRecord record;
    for (bool is_begin = is_first; reader.next(record); is_begin = false) {
      if (is_begin) tellOfBegin(path_, part, record.t_s);
      printContacts(scene_, watch_.add(record), as_json_);
    }
    return true;
  }

  const std::string path_;
  const Scene scene_;
  ContactWatch watch_;
  const bool as_json_;
  std::optional<std::string> run_;
  int next_part_ = 0;
};

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
  command
      ->add_option("log", options->log,
                   "Log of a run (run.ulg); else all that there are of the daemon that runs")
      ->check(isNamed);
  command->add_flag("--follow", options->follows, "Go on with those that come, until the run ends");
  command->add_flag("--json", options->json, "Print JSON; with --follow an object a line");
  command->callback([options, &exit_code] {
    exit_code = kExitDone;
    const bool whole_run = options->log.empty();
    if (whole_run) options->log = runningLog();
    if (options->follows) return ContactPrinter(options->log, options->json).follow(whole_run);
    const std::vector<std::string> paths =
        whole_run ? logsOfRun(options->log) : std::vector<std::string>{options->log};
    const LoggedContacts logged = readContacts(paths);
    tellOfBegin(paths.front(), logged.first_part, logged.begin_s);
    if (logged.is_cut_off) fmt::print(stderr, "{}: the log was cut off\n", escaped(options->log));
    std::fputs((options->json ? jsonText(contactsJson(logged)) : contactsText(logged)).c_str(),
               stdout);
  });
}

}  // namespace tactus
