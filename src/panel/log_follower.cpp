#include "tactus/panel/log_follower.h"

#include <algorithm>
#include <istream>
#include <utility>

#include "tactus/record/contact_json.h"
#include "tactus/record/logged_scene.h"

namespace tactus {
namespace {

constexpr double kBin_s = 0.01;
constexpr std::size_t kPastBins = 30000;  ///< five minutes
constexpr std::size_t kMaxContacts = 50;
constexpr double kLookAtLasting_s = 0.25;
constexpr double kLookAtPast_s = 60.0;  ///< while the past is being read
/// A contact's trace, from its touch on.
constexpr double kTraceBefore_s = 0.2;
constexpr double kTraceAfter_s = 3.0;
constexpr std::size_t kTraceBins = 200;

}  // namespace

LogFollower::LogFollower(std::string path)
    : path_(std::move(path)),
      bins_(kBin_s),
      thread_([this](const std::stop_token& stop) { follow(stop); }) {}

void LogFollower::follow(const std::stop_token& stop) {
  std::string problem;
  try {
    while (readFile(stop)) {
    }
  } catch (const std::exception& error) {
    problem = error.what();
  }
  const std::lock_guard lock(mutex_);
  news_.problem = problem.empty() ? "the log has ended" : problem;
}

/// One file of the log; true: it goes on in another one.
bool LogFollower::readFile(const std::stop_token& stop) {
  {
    const std::lock_guard lock(mutex_);
    file_.emplace(path_, stop);
  }
  std::istream in(&*file_);
  UlogReader reader(in, path_);
  const LogDescription& description = reader.description();
  const Scene scene = loggedScene(reader, path_);
  reader.assumeGains(scene.controller.gains);
  if (!watch_) watch_.emplace(scene.controller);
  {
    const std::lock_guard lock(mutex_);
    start_ = RunStart{description.sources, description.overrides};
    news_.links = scene.module_links;
  }
  CycleRecord record;
  while (!stop.stop_requested() && reader.next(record)) add(record, file_->isLive());
  return file_->goesOn() && !stop.stop_requested();
}

void LogFollower::add(const CycleRecord& record, bool is_live) {
  const std::vector<ContactFigures> over = watch_->add(record);
  const double pause_s = is_live ? kLookAtLasting_s : kLookAtPast_s;
  const bool looks = record.t_s >= lasting_s_ + pause_s || !over.empty();
  const std::vector<ContactFigures> lasting =
      looks ? watch_->present() : std::vector<ContactFigures>{};
  if (looks) lasting_s_ = record.t_s;
  const std::lock_guard lock(mutex_);
  bins_.add(record.t_s, {record.force_sensor_N, news_.links.size()});
  for (const ForceBin& bin : std::exchange(bins_.complete(), {})) {
    past_.push_back(bin);
    if (past_.size() > kPastBins) past_.pop_front();
    news_.bins.push_back(bin);
  }
  news_.gains = record.gains;
  for (const ContactFigures& figures : over) news_.contacts.push_back(contact(figures));
  if (news_.contacts.size() > kMaxContacts) news_.contacts.erase(news_.contacts.begin());
  if (news_.bins.size() > kPastBins) news_.bins = fewerBins(news_.bins, kPastBins / 2);
  if (!looks) return;
  news_.lasting.clear();
  for (const ContactFigures& figures : lasting) news_.lasting.push_back(contact(figures));
}

Json LogFollower::contact(const ContactFigures& figures) {
  Json json = contactJson(figures, news_.links);
  Begun& begun = begun_[static_cast<std::size_t>(figures.module)];
  if (begun.start_s != figures.start_s) {
    json["trace"] = trace(figures);
    const bool is_whole = figures.end_s > figures.start_s + kTraceAfter_s;
    if (is_whole) begun = {figures.start_s, json["trace"]};
  } else {
    json["trace"] = begun.trace;
  }
  return json;
}

Json LogFollower::trace(const ContactSummary& contact) const {
  const double from_s = contact.start_s - kTraceBefore_s;
  const double to_s = std::min(contact.end_s + kTraceBefore_s, contact.start_s + kTraceAfter_s);
  std::vector<ForceBin> touched;
  for (auto bin = past_.rbegin(); bin != past_.rend() && bin->to_s > from_s; ++bin)
    if (bin->from_s < to_s) touched.push_back(*bin);
  std::ranges::reverse(touched);
  return forceJson(fewerBins(touched, kTraceBins), contact.module, 1, contact.start_s);
}

LogNews LogFollower::news() {
  const std::lock_guard lock(mutex_);
  // Also of a log that stands still; and for good, where it goes on in another file.
  news_.is_live = news_.is_live || (start_ && file_ && file_->isLive());
  LogNews news = news_;
  news_.bins.clear();
  news_.contacts.clear();
  return news;
}

std::optional<RunStart> LogFollower::start() const {
  const std::lock_guard lock(mutex_);
  return start_;
}

}  // namespace tactus
